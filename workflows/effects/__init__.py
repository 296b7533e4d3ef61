"""The effects, a module each, named as its key: when it is called for, what rules it out, its words, terms and costs.

`selection` decides by these which a scene has. May import scene, and `fem` to look at coarse meshes.
"""
