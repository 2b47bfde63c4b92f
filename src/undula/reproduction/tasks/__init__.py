"""Tasks of a reproduction: the commands whose answers the claims are checked against."""
