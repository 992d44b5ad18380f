"""Hunts as parallel environments of PettingZoo. They need the extra `learning`; see docs/how-to/learning.md."""

from thbridge.api.learning.abstract_environment import AbstractHuntEnv as AbstractHuntEnv
from thbridge.api.learning.environment import HuntEnv as HuntEnv
from thbridge.api.learning.environment import parallel_env as parallel_env
