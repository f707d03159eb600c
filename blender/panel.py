# SPDX-License-Identifier: GPL-3.0-or-later
"""The side panel (N) of the 3D viewport, tab Mid-air."""

import textwrap

import bpy

from . import properties

ICONS = {"fault": "CANCEL", "warning": "ERROR", "note": "INFO"}


def _lines(layout, text, icon="NONE", width=46):
    """A sentence over several lines: labels do not wrap by themselves."""
    for number, line in enumerate(textwrap.wrap(text, width) or [""]):
        layout.label(text=line, icon=icon if number == 0 else "BLANK1")


class MIDAIR_PT_panel(bpy.types.Panel):
    bl_idname = "MIDAIR_PT_panel"
    bl_label = "Mid-air"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Mid-air"

    def draw(self, context):
        layout = self.layout
        root = properties.root_of(context)
        if root is None:
            _lines(
                layout,
                "There is no mid-air set-up, or more than one. Add > Light > Mid-air adds one; select the one that is meant.",
                "INFO",
            )
            return
        own = root.midair
        layout.template_ID(own, "picture", open="image.open")
        layout.prop(own, "way", text="")
        if own.way == "BAKED":
            layout.prop(own, "optimal")
        row = layout.row(align=True)
        row.scale_y = 1.4
        row.operator("midair.compensate", icon="LIGHT_AREA")
        row.prop(own, "live", toggle=True)
        layout.operator("midair.uncompensated")
        row = layout.row(align=True)
        row.prop(own, "show_rays", toggle=True)
        row.prop(own, "ray_count", text="a side")
        layout.operator("midair.set_up_render", icon="RENDER_STILL")
        row = layout.row(align=True)
        row.operator("midair.sync")
        row.operator("midair.reload", text="Rebuild")


class MIDAIR_PT_status(properties.OfSetUp, bpy.types.Panel):
    bl_idname = "MIDAIR_PT_status"
    bl_label = "Status"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Mid-air"
    bl_parent_id = "MIDAIR_PT_panel"

    def draw(self, context):
        own = properties.root_of(context).midair
        layout = self.layout
        if own.said:
            _lines(layout, own.said, "CANCEL")
        if own.formed >= 0.0:
            layout.label(text=f"{own.formed:.1%} of the image is formed")
        else:
            layout.label(text="Not compensated yet")
        for finding in own.findings:
            box = layout.box()
            _lines(box, finding.sentence, ICONS.get(finding.severity, "INFO"))
            if finding.remedy:
                _lines(box, finding.remedy, "RIGHTARROW_THIN")


class MIDAIR_PT_part(bpy.types.Panel):
    bl_idname = "MIDAIR_PT_part"
    bl_label = "Selected Part"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Mid-air"
    bl_parent_id = "MIDAIR_PT_panel"

    @classmethod
    def poll(cls, context):
        thing = context.active_object
        return thing is not None and thing.midair.role not in ("NONE", "SETUP")

    def draw(self, context):
        thing = context.active_object
        layout = self.layout
        layout.label(text=f"{thing.midair.role.title()}: millimetres")
        layout.prop(thing, "location", text="Position")
        layout.prop(thing, "rotation_euler", text="Rotation")
        if thing.midair.role in ("IMAGE", "PLATE", "DISPLAY"):
            layout.prop(thing, "scale", text="Size")
        for key in properties.own_keys(thing):
            layout.prop(thing, f'["{key}"]', text=key)


CLASSES = (MIDAIR_PT_panel, MIDAIR_PT_status, MIDAIR_PT_part)


register, unregister = bpy.utils.register_classes_factory(CLASSES)
