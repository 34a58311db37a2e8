# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's window, as a user works with it."""
import os
import shutil
import unittest

import common
import gui

MODEL = os.path.basename(common.PIPE)
PLANE = (gui.PANEL +
         '/SliceType/ProxySelectionWidget/frame/ChosenProxyWidget/InteractivePlane')
CELLS = 'simple.GetActiveSource().GetDataInformation().GetNumberOfCells()'
SELECT_MODEL = f'simple.SetActiveSource(simple.FindSource({MODEL!r}))'


def shown(pipeline):
    return [name for name, values in pipeline.items() if values[3]]


@unittest.skipUnless(shutil.which('paraview'), 'paraview is not here')
class GUI(unittest.TestCase):
    def session(self):
        session = gui.Session()
        self.addCleanup(session.folder.cleanup)
        return session

    def test_open_color_slice_contour_undo_trace_and_state(self):
        session = self.session()
        state = session.path('state.pvsm')

        def look(name):
            session.python(f"{gui.PIPELINE}\nrecord({name}=pipeline)\n"
                           f"simple.SaveScreenshot({session.path(name + '.png')!r}, view)")

        session.start_trace()
        session.load_plugin()
        session.open(common.PIPE, several_readers=True)
        session.apply()
        session.color_by('Temperature (partial)')
        look('solid')
        session.python("colors = simple.GetColorTransferFunction('Temperature').RGBPoints\n"
                       "record(legend=[colors[0], colors[-4]])")

        session.quick_launch('nurbs slice', 'NURBS Slice')
        session.check(PLANE + '/show3DWidget', 'checked', 'true')
        session.python('record(begin=list(simple.GetActiveSource().SliceType.Origin))')
        session.event(PLANE + '/useYNormal')
        session.event(PLANE + '/originY', 'set_string', '1.5')
        session.apply()
        look('slice')
        session.python(SELECT_MODEL)
        session.filter('NURBSContour')
        session.event(gui.PANEL + '/ContourBy/ComboBox', 'set_string', 'Temperature (partial)')
        session.check(gui.PANEL + '/Component', 'visible', 'false')
        session.event(gui.PANEL + '/Isosurfaces/Reset')
        session.apply()
        session.python('contour = simple.GetActiveSource()\nrecord(values=list(contour.Isosurfaces),'
                       "coefficients=contour.Input.PointData['Temperature'].GetRange())")
        look('contour')
        session.stop_trace()

        session.event(gui.TOLERANCE, 'set_string', '1e-05')
        session.apply()
        # Nothing that sets a property may come between a change and its undoing.
        session.python(f'record(fine={CELLS})')
        session.event('menubar/menu_Edit', 'activate', 'actionEditUndo')
        session.check(gui.TOLERANCE, 'text', '0.001')
        look('undone')

        session.event('menubar/menu_File', 'activate', 'actionFileSaveServerState')
        session.event('FileSaveServerStateDialog', 'filesSelected', state)
        session.python('simple.ResetSession()')
        session.python('record(left=len(simple.GetSources()))')
        session.event('menubar/menu_File', 'activate', 'actionFileLoadServerState')
        session.event('FileLoadServerStateDialog', 'filesSelected', state)
        session.event('/LoadStateOptionsDialog/widget/OKButton')
        look('loaded')
        seen = session.play()

        model = seen['solid'][MODEL]
        self.assertEqual(model[3:], [1, 'NURBS Solid', 'Temperature'])
        # The values on the solid, not the coefficients, which reach beyond 200.
        self.assertAlmostEqual(seen['legend'][0], 20.0, 3)
        self.assertLess(seen['legend'][1], 150.0)
        # The plane begins in the middle, and its slice replaces the model.
        for low, high, middle in zip(model[2][::2], model[2][1::2], seen['begin']):
            self.assertAlmostEqual(middle, 0.5 * (low + high))
        self.assertEqual(shown(seen['slice']), ['NURBSSlice1'])
        bounds = seen['slice']['NURBSSlice1'][2]
        self.assertLess(max(abs(bounds[2] - 1.5), abs(bounds[3] - 1.5)), 1e-11)
        # The value begins in the middle of the coefficients' range.
        low, high = seen['coefficients']
        self.assertAlmostEqual(seen['values'][0], 0.5 * (low + high))
        self.assertGreater(seen['contour']['NURBSContour1'][1], 100)
        self.assertEqual(shown(seen['contour']), ['NURBSContour1', 'NURBSSlice1'])
        self.assertGreater(seen['fine'], 2 * seen['contour']['NURBSContour1'][1])
        self.assertEqual(seen['undone'], seen['contour'])
        pictures = [common.read_picture(session.path(name + '.png'))
                    for name in ('solid', 'slice', 'contour', 'loaded')]
        for picture in pictures:
            self.assertGreater((picture != picture[0, 0]).any(axis=2).sum(), 100)

        # A state and a trace bring the same back.
        self.assertEqual(seen['left'], 0)
        self.assertEqual(seen['loaded'], seen['contour'])
        self.assertEqual((pictures[2] != pictures[3]).sum(), 0)
        self.assertEqual(session.replay_trace(), seen['contour'])

    def test_panels_of_contour_and_clip_show_what_applies(self):
        session = self.session()
        session.load_plugin()
        session.open(common.PIPE, several_readers=True)
        session.apply()

        def expect(**visible):
            for name, is_visible in visible.items():
                session.check(f'{gui.PANEL}/{name}', 'visible', str(is_visible).lower())

        session.filter('NURBSContour')
        session.event(gui.PANEL + '/ContourBy/ComboBox', 'set_string', 'Temperature (partial)')
        expect(ContourBy=True, Component=False)
        session.event(gui.PANEL + '/ContourOf/ComboBox', 'set_string', 'Coordinates')
        expect(ContourBy=False, Component=True)
        session.event(gui.PANEL + '/ContourOf/ComboBox', 'set_string', 'Jacobian Determinant')
        expect(ContourBy=False, Component=False)
        session.python('simple.Delete(simple.GetActiveSource())\n' + SELECT_MODEL)
        session.filter('NURBSClip')
        expect(ClipBy=False, Scalars=False, Component=False, Value=False, Invert=True)
        session.event(gui.CLIP_TYPE, 'set_string', 'Scalar')
        session.event(gui.PANEL + '/Scalars/ComboBox', 'set_string', 'Temperature (partial)')
        expect(ClipBy=True, Scalars=True, Component=False, Value=True)
        session.event(gui.PANEL + '/ClipBy/ComboBox', 'set_string', 'Parametric Coordinates')
        expect(Scalars=False, Component=True, Value=True)
        session.event(gui.CLIP_TYPE, 'set_string', 'Sphere')
        expect(ClipBy=False, Scalars=False, Component=False, Value=False)
        session.apply()
        session.python(f'record(cells={CELLS})')
        self.assertGreater(session.play()['cells'], 100)

    def test_controls_that_do_not_apply_are_hidden(self):
        session = self.session()
        session.load_plugin()
        session.open(os.path.join(common.DATA, 'two_blocks.txt'), several_readers=True)
        session.apply()
        session.filter('NURBSExtractPatches')
        controls = ('PatchIds', 'BoundaryName', 'Box')
        for choice, control in zip(('Patch Ids', 'Boundary', 'Box'), controls):
            session.event(gui.PANEL + '/ExtractBy/ComboBox', 'set_string', choice)
            for name in controls:
                session.check(f'{gui.PANEL}/{name}', 'visible',
                              'true' if name == control else 'false')
        session.check(gui.PANEL + '/BoundaryName/ComboBox', 'currentText', 'BOUNDARY left')
        session.check(gui.BOX + '/show3DWidget', 'checked', 'true')
        session.event(gui.BOX + '/translateX', 'set_string', '1.25')
        session.apply()
        session.python('record(bounds=simple.GetActiveSource().GetDataInformation().GetBounds())')
        self.assertEqual(session.play()['bounds'][:2], [1.0, 2.0])

    def test_a_curve_of_the_panel_becomes_a_surface(self):
        session = self.session()
        session.load_plugin()
        session.source('NURBSCurve')
        session.check(gui.PANEL + '/InteractivePolyLine/show3DWidget', 'checked', 'true')
        session.apply()
        session.filter('NURBSRevolve')
        session.event(gui.PANEL + '/Angle/DoubleRangeWidget/DoubleLineEdit', 'set_string', '180')
        session.apply()
        session.python(f'{gui.PIPELINE}\nrecord(pipeline=pipeline)')
        session.source('NURBSPrimitive')
        for shape, shown_controls in (('Box', ['Lengths']), ('Tube', ['Radius', 'InnerRadius']),
                                      ('Helix', ['Radius', 'Pitch', 'Parametrisation'])):
            session.event(gui.PANEL + '/Shape/ComboBox', 'set_string', shape)
            for name in ('Lengths', 'Radius', 'InnerRadius', 'Pitch', 'Parametrisation'):
                session.check(f'{gui.PANEL}/{name}', 'visible',
                              'true' if name in shown_controls else 'false')
        session.apply()
        session.python(f'record(cells={CELLS})')
        seen = session.play()
        self.assertGreater(seen['cells'], 0)
        self.assertEqual(shown(seen['pipeline']), ['NURBSRevolve1'])
        bounds = seen['pipeline']['NURBSRevolve1'][2]
        # Half a turn about y, towards -z.
        self.assertAlmostEqual(bounds[0], -bounds[1])
        self.assertAlmostEqual(bounds[4], -bounds[1])
        self.assertAlmostEqual(bounds[5], 0)

    def test_a_fit_stays_in_the_view(self):
        session = self.session()
        session.load_plugin()
        session.event('menubar/menuSources/Alphabetical', 'activate', 'RTAnalyticSource')
        session.apply()
        session.filter('NURBSFit')
        controls = ('FitTo', 'ControlPoints', 'TargetError', 'ErrorMeasure', 'Smoothing')

        def check(*visible):
            for name in controls:
                session.check(f'{gui.PANEL}/{name}', 'visible',
                              'true' if name in visible else 'false')

        check()
        session.event(gui.PANEL + '/Method/ComboBox', 'set_string', 'Least Squares')
        check('FitTo', 'ControlPoints', 'Smoothing')
        session.event(gui.PANEL + '/FitTo/ComboBox', 'set_string', 'Target Error')
        check('FitTo', 'TargetError', 'ErrorMeasure')
        session.apply()
        # The table opens no view, in which the next filter would be shown.
        session.python('record(view=simple.GetActiveView().GetXMLName())')
        session.python(f'{gui.PIPELINE}\nrecord(pipeline=pipeline)')
        seen = session.play()
        self.assertEqual(seen['view'], 'RenderView')
        self.assertEqual(shown(seen['pipeline']), ['NURBSFit1'])


if __name__ == '__main__':
    unittest.main()
