"""Scenarios that are a dialogue: what is typed is answered; see docs/talking.md."""
