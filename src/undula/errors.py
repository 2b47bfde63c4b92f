"""The one exception for mistakes that a user can put right."""


class InputError(ValueError):
    """A mistake in the input, told in one sentence that names the culprit and the cure.

    Whatever faces the user shows the text of this exception as it is, without a traceback.
    """
