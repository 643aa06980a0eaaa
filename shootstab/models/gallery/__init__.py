"""Solved problems with their published digits; each is also the shortest example of how to write one down."""

from __future__ import annotations

from shootstab.models.gallery.benard import benard
from shootstab.models.gallery.blasius import blasius
from shootstab.models.gallery.plate import malik_3, malik_6, plate
from shootstab.models.gallery.poiseuille import PlanePoiseuille, plane_poiseuille
from shootstab.models.gallery.potentials import davies, poeschl_teller
from shootstab.models.gallery.shear_layer import shear_layer
from shootstab.models.gallery.suction import suction

__all__ = [
    "PlanePoiseuille",
    "benard",
    "blasius",
    "davies",
    "malik_3",
    "malik_6",
    "plane_poiseuille",
    "plate",
    "poeschl_teller",
    "shear_layer",
    "suction",
]
