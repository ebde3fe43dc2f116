"""Head and trunk: gaze, breath, sway and posture."""
