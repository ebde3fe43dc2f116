"""Long test runs in virtual time: `python -m tests.campaigns.wire` and others."""
