"""Long hunts for broken promises, in virtual time: `python -m tests.campaigns.wire` and others."""
