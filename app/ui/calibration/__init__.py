"""The coach that leads a person through a calibration."""
