# SPDX-License-Identifier: BSD-3-Clause
"""Loads a state of Examples/ as a user does and writes what its script writes.

    PV_PLUGIN_CONFIG_FILE=<prefix>/.../hyperpatch.plugins.xml pvpython RunState.py \\
        STATE DATA FOLDER SURFACE...
"""
import os
import sys

from paraview import simple

state, data, folder, *surfaces = sys.argv[1:]
# As ticking it in Tools > Manage Plugins does.
simple.LoadDistributedPlugin('Hyperpatch', remote=False)
simple.LoadState(state, data_directory=data, restrict_to_data_directory=True)
for name in surfaces:
    simple.SaveData(os.path.join(folder, name + '.vtp'), simple.FindSource(name),
                    DataMode='Binary')
simple.SaveScreenshot(os.path.join(folder, 'picture.png'), simple.GetActiveView())
