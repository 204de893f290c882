"""Every error that a user can cause. Each message is one sentence: what is wrong, where, what to do.

The command prints the message and leaves with code 2; the library raises it as an ordinary exception.
"""


class WeingartenError(Exception):
    """Base of every error that a user can cause and mend."""


class InputError(WeingartenError):
    """A file cannot be read as what its name promises: missing, empty, truncated, of unknown format."""


class CloudError(WeingartenError):
    """The points were read, but no part can be fitted to them: too few, collinear, not finite."""


class OutputError(WeingartenError):
    """A result cannot be written where it was asked for."""


class BusyError(WeingartenError):
    """A run folder is being written by another process."""


class OptionError(WeingartenError):
    """An option or argument has a value outside what is documented."""


class CheckpointError(WeingartenError):
    """A run folder or checkpoint is missing, corrupted or of another configuration."""


class DeviceError(WeingartenError):
    """The requested device is not on this machine."""


class MissingExtraError(WeingartenError):
    """An optional dependency is not installed; the message says what to install."""


class ExtractionError(WeingartenError):
    """The field has no zero crossing where a surface was looked for."""


class FitError(WeingartenError):
    """The optimisation left the realm of numbers."""
