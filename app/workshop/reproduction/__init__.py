"""The printed tables of the four works, each beside what this program gives.

One module for each; `registry` lists them.
"""
