"""Ways of writing the same that are refused all the same. Any other refusal of a file that says the same is a fault.

Each is known by the kinds of file, and by what the one line says; beside it is where the program's own pages say that it is refused.
"""

import re

REFUSED = (
    ("leading zeros", ("sweep", "base", "airframe", "option", "world", "log-format"), r"'[+-]?0\d[^']*' is (not allowed|not a number)"),  # trust.md: 010
    ("NPY 2.0 or 3.0", ("recording",), r"is no NPY 1\.0 file"),  # OWN_DATA.md
    ("not parted by commas, or lines that CR alone ends", ("labels",), r"labels\.csv"),  # OWN_DATA.md
    ("an alpha", ("detector",), r"operator Gemm .* has alpha = \S+; allowed: 1$"),  # OWN_DATA.md: put right or refused
    ("an alpha", ("policy",), r"has an alpha or a beta that is not 1"),  # its own line tells what is allowed
)


def known(kind, line):
    """The way of writing that this line refuses, or ''."""
    return next((way for way, kinds, words in REFUSED if kind in kinds and re.search(words, line)), "")
