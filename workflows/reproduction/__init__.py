"""The paper's statements against this code, one by one."""

from workflows.reproduction.claim import Claim, Verdict
from workflows.reproduction.reproduce import Reproduction, reproduce

__all__ = ["Claim", "Reproduction", "Verdict", "reproduce"]
