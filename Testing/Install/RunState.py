# SPDX-License-Identifier: BSD-3-Clause
"""Loads Examples/pipeline.pvsm as a user does and writes what Examples/pipeline.py writes.

    PV_PLUGIN_CONFIG_FILE=<prefix>/.../hyperpatch.plugins.xml pvpython RunState.py STATE DATA FOLDER
"""
import os
import sys

from paraview import simple

state, data, folder = sys.argv[1:]
# As ticking it in Tools > Manage Plugins does.
simple.LoadDistributedPlugin('Hyperpatch', remote=False)
simple.LoadState(state, data_directory=data, restrict_to_data_directory=True)
for name in ('slice', 'contour', 'boundary'):
    simple.SaveData(os.path.join(folder, name + '.vtp'), simple.FindSource(name),
                    DataMode='Binary')
simple.SaveScreenshot(os.path.join(folder, 'picture.png'), simple.GetActiveView())
