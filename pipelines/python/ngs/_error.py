"""The one exception of this package."""


class Error(RuntimeError):
    """A tool failed, or a file cannot be read. code is the exit code of the tools, remedy may be empty."""

    def __init__(self, code: int, message: str, remedy: str = "") -> None:
        super().__init__(message + ("\nhint: " + remedy if remedy else ""))
        self.code = code
        self.message = message
        self.remedy = remedy
