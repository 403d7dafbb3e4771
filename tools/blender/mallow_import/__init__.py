"""Opens the folder of a run of mallow in Blender as a sequence; see README.md in the folder above."""
import bpy

from .run_files import ImportFailure
from .sequence import import_run, register_handler, unregister_handler

bl_info = {
    "name": "mallow runs",
    "description": "Opens the surfaces of a run of mallow as a sequence",
    "author": "mallow",
    "version": (0, 1, 0),
    "blender": (3, 3, 0),
    "location": "File > Import > mallow run",
    "category": "Import-Export",
}


class MALLOW_OT_import(bpy.types.Operator):
    """Open the surfaces of a run of mallow as a sequence"""

    bl_idname = "import_scene.mallow"
    bl_label = "Import mallow run"
    bl_options = {"REGISTER", "UNDO"}

    directory: bpy.props.StringProperty(name="Folder", description="What `mallow run --out` wrote", subtype="DIR_PATH")
    set_scene: bpy.props.BoolProperty(name="Set frames", description="Take frame range and rate of the run",
                                      default=True)

    def invoke(self, context, _event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, _context):
        try:
            import_run(self.directory, self.set_scene)
        except (ImportFailure, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def menu(self, _context):
    self.layout.operator(MALLOW_OT_import.bl_idname, text="mallow run (folder)")


def register():
    bpy.utils.register_class(MALLOW_OT_import)
    bpy.types.TOPBAR_MT_file_import.append(menu)
    register_handler()


def unregister():
    unregister_handler()
    bpy.types.TOPBAR_MT_file_import.remove(menu)
    bpy.utils.unregister_class(MALLOW_OT_import)
