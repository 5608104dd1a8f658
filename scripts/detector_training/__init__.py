"""The parts of scripts/train_detector.py."""
