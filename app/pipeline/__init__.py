"""The pipeline for one frame."""
