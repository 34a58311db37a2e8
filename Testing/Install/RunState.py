# SPDX-License-Identifier: BSD-3-Clause
"""Loads Examples/pipeline.pvsm as a user does and writes what Examples/pipeline.py writes.

    pvpython RunState.py PLUGIN STATE DATA FOLDER
"""
import os
import sys

from paraview import simple

plugin, state, data, folder = sys.argv[1:]
simple.LoadPlugin(plugin, remote=False)
simple.LoadState(state, data_directory=data, restrict_to_data_directory=True)
for name in ('slice', 'contour', 'boundary'):
    simple.SaveData(os.path.join(folder, name + '.vtp'), simple.FindSource(name),
                    DataMode='Binary')
simple.SaveScreenshot(os.path.join(folder, 'picture.png'), simple.GetActiveView())
