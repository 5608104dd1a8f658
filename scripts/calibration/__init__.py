"""History matching of the paper's world: what the paper leaves open, judged by what it says of its random walk."""
