# SPDX-License-Identifier: BSD-3-Clause
"""Opens the samples by content, saves one as .vtpc and opens it again."""

import os
import tempfile

from paraview import simple

simple.LoadPlugin(os.environ["HYPERPATCH_PLUGIN"], remote=False)
data = os.environ["HYPERPATCH_DATA"]

for name in ("heated_pipe_bend.vtpc", "folded_sweep.xml", "tube_on_block.xml", "quarter_tube.g2",
             "twisted_bar.mesh"):
    reader = simple.OpenDataFile(os.path.join(data, name))
    assert reader.GetXMLName() == "BSplineReader", (name, reader.GetXMLName())
    reader.UpdatePipeline()
    information = reader.GetDataInformation()
    assert information.GetDataSetTypeAsString() == "vtkPartitionedDataSetCollection", name
    assert information.GetNumberOfPoints() > 0, name

# What is no spline file goes to the reader that it went to without the plugin.
with tempfile.TemporaryDirectory() as folder:
    table = os.path.join(folder, "table.csv")
    with open(table, "w", encoding="ascii") as file:
        file.write("a,b\n1,2\n")
    assert simple.OpenDataFile(table).GetXMLName() == "CSVReader"

    pipe = simple.OpenDataFile(os.path.join(data, "heated_pipe_bend.vtpc"))
    saved = os.path.join(folder, "saved.vtpc")
    simple.SaveData(saved, proxy=pipe, DataMode="Binary")
    again = simple.OpenDataFile(saved)
    assert again.GetXMLName() == "BSplineReader", again.GetXMLName()
    again.UpdatePipeline()
    for arrays in (lambda proxy: proxy.PointData, lambda proxy: proxy.FieldData):
        assert sorted(arrays(again).keys()) == sorted(arrays(pipe).keys())
