"""Pictures of a scene in one call."""
from . import _mallow


def render(scene, simulation, mesh=None, file=None, camera=None, threads=0):
    """A picture of a simulation that build(scene) made, as an array of height x width x 3 bytes, sRGB.

    mesh: what is drawn, with a material id for each vertex; left out, the surface of all bodies as scene.surface says,
    skins left aside. file: a PNG to write it to as well. camera: a Camera; left out, one that has in view what the
    simulation is in now. For a film, keep a Renderer, a Surfacer and a Camera.
    """
    if file is not None and not str(file).lower().endswith(".png"):
        raise ValueError(f"file: '{file}' is not allowed: pictures are PNG files")
    if mesh is None:
        mesh = _mallow.Surfacer(scene.surface, threads).draw(simulation)
    colliders = _mallow.visible_colliders(scene)
    if camera is None:
        camera = _mallow.frame_camera(_mallow.bounds_now(scene, simulation), scene.render, colliders)
    image = _mallow.Renderer(scene.render, threads).render(mesh, _mallow.body_appearances(scene, simulation),
                                                         colliders, camera)
    if file is not None:
        _mallow.write_png(file, image)
    return image
