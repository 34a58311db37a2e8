# SPDX-License-Identifier: BSD-3-Clause
"""A trace of what a user chooses in ParaView's panels brings the same back in pvpython."""
import os
import shutil
import unittest

import common
import gui

MODEL = os.path.basename(common.PIPE)


@unittest.skipUnless(shutil.which('paraview'), 'paraview is not here')
class Trace(unittest.TestCase):
    def test_the_choices_of_filters_replay(self):
        session = gui.Session()
        self.addCleanup(session.folder.cleanup)
        session.start_trace()
        session.load_plugin()
        session.open(common.PIPE, several_readers=True)
        session.apply()

        def begin(name):
            session.python(f'simple.SetActiveSource(simple.FindSource({MODEL!r}))')
            session.filter(name)

        def apply():
            session.event(gui.TOLERANCE, 'set_string', '0.01')
            session.event(gui.TOLERANCE.replace('Tolerance', 'AttributeTolerance'), 'set_string',
                          '0.1')
            session.apply()

        def contour(of, component, first, last):
            begin('NURBSContour')
            session.event(gui.PANEL + '/ContourBy/ComboBox', 'set_string', 'Displacement (partial)')
            session.event(gui.PANEL + '/ContourOf/ComboBox', 'set_string', of)
            session.event(gui.PANEL + '/Component/LineEdit0', 'set_string', component)
            session.event(gui.PANEL + '/Isosurfaces/ScalarValueList/RemoveAll')
            session.add_values('Isosurfaces', first, last)
            apply()

        contour('Attribute', '-1', 0.005, 0.01)
        contour('Coordinates', '1', 0.5, 1.5)
        contour('Parametric Coordinates', '2', 0.25, 0.75)
        contour('Jacobian Determinant', '0', 0, 1)
        begin('NURBSSlice')
        session.add_values('SliceOffsetValues', -0.3, 0.3)
        apply()
        begin('NURBSClip')
        session.event(gui.CLIP_TYPE, 'set_string', 'Scalar')
        session.event(gui.PANEL + '/ClipBy/ComboBox', 'set_string', 'Attribute')
        session.event(gui.PANEL + '/Scalars/ComboBox', 'set_string', 'Temperature (partial)')
        session.event(gui.PANEL + '/Value/DoubleRangeWidget/DoubleLineEdit', 'set_string', '60')
        apply()
        begin('NURBSClip')
        session.event(gui.CLIP_TYPE, 'set_string', 'Sphere')
        session.event(gui.PANEL + '/Invert/CheckBox', 'set_boolean', 'false')
        apply()
        begin('NURBSExtractPatches')
        session.event(gui.PANEL + '/ExtractBy/ComboBox', 'set_string', 'Box')
        session.event(gui.BOX + '/translateX', 'set_string', '1.25')
        session.event(gui.BOX + '/scaleY', 'set_string', '0.75')
        session.apply()
        session.python('box = simple.GetActiveSource().Box\n'
                       'record(box=[box.Position[0], box.Length[1]])')
        session.stop_trace()
        session.python(f'{gui.PIPELINE}\nrecord(pipeline=pipeline)')
        seen = session.play()
        self.assertEqual(seen['box'], [1.25, 0.75])
        self.assertEqual(len(seen['pipeline']), 9)
        for name, values in seen['pipeline'].items():
            self.assertGreater(values[1], 0, name)
        self.assertEqual(session.replay_trace(), seen['pipeline'])


if __name__ == '__main__':
    unittest.main()
