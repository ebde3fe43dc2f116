"""The character itself: skeleton, meshes, clips, and the file beside them."""
