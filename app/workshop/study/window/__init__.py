"""A study in a window: texts, questions and stimuli, by keyboard and mouse."""
