"""The driver for Petoi's Bittle and Nybble, and for other boards with OpenCat."""
