"""Motion matching: at each moment, the frame of all recordings that suits pose and wish best.

Sources: Büttner and Clavet, "Motion matching: the road to next gen animation", nucl.ai 2015; the
features and weights of Holden et al., "Learned motion matching", SIGGRAPH 2020.
"""
