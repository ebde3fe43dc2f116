"""The passes that draw a picture, one file each; `Stage` lists them in their order."""
