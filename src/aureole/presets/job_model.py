"""What the file of a whole job may hold, checked with pydantic."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class JobPreset(BaseModel):
    """A whole job: a command and its flags.

    Parameters
    ----------
    title : str
        What it is, for a person.
    source : str
        Where the numbers come from.
    command : str
        Such as "glare" or "surface render"; a job without serves every command that has its flags.
    job : dict
        Flags by their names without dashes, arguments by theirs in lower case; values as they are typed.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    title: str = ""
    source: str = ""
    command: str = ""
    job: dict[str, Any] = Field(default_factory=dict)
