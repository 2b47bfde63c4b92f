"""Keys of a claim of the paper with its value: a row of claims.json and of an answer."""

from undula.schema.key_kinds import UNITLESS, Keys, Named, plain

#: A claim of the paper and its value; also a row of claims.json.
CLAIM: Keys = {
    **plain("claim", "item", "figure", "title", "says", "published", "within", "over_a_range"),
    **plain("command", "value", "error", "unit", "verdict", "reason", "because", "note"),
    **plain("expected", "as_expected", "erratum", "silent", "steps", "where"),
    # The settings that the value is computed at.
    "at": Named(UNITLESS),
}
