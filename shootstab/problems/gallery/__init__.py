"""Solved problems with their published digits; each is also the shortest example of how to write one down."""

from __future__ import annotations

from shootstab.problems.gallery.benard import benard
from shootstab.problems.gallery.blasius import blasius
from shootstab.problems.gallery.plate import malik_3, malik_6, plate
from shootstab.problems.gallery.poiseuille import PlanePoiseuille, plane_poiseuille
from shootstab.problems.gallery.potentials import davies, poeschl_teller
from shootstab.problems.gallery.shear_layer import shear_layer
from shootstab.problems.gallery.suction import suction

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
