"""The paper's statements against this code, one by one."""

from workflows.studies.reproduction.claims import Claim, Verdict
from workflows.studies.reproduction.report import Reproduction, reproduce

__all__ = ["Claim", "Reproduction", "Verdict", "reproduce"]
