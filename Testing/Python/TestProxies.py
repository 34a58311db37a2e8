# SPDX-License-Identifier: BSD-3-Clause
"""What state files, scripts and panels rely on: names, documentation and defaults."""
import os
import re
import tempfile
import unittest
from xml.etree import ElementTree

import common  # loads the plugin
from paraview import servermanager, simple

PROXIES = [('sources', 'BSplineReader'), ('filters', 'NURBSTessellate'), ('filters', 'NURBSSlice'),
           ('filters', 'NURBSContour'), ('filters', 'NURBSJacobianBoundary'),
           ('filters', 'NURBSExtractPatches'), ('filters', 'NURBSFit')]
# Filters that make models of other data.
TAKE_OTHER_DATA = ('NURBSFit',)
STYLE = ('representations', 'NURBSSolidRepresentation')
STYLE_PROPERTIES = ('SolidTolerance', 'SolidAttributeTolerance')


def new_proxy(group, name):
    proxy = servermanager.ProxyManager().SMProxyManager.NewProxy(group, name)
    proxy.UpdateVTKObjects()
    return proxy


def properties(proxy):
    """Names and properties, without those that NURBS Solid inherits."""
    iterator = proxy.NewPropertyIterator()
    iterator.Begin()
    while not iterator.IsAtEnd():
        if proxy.GetXMLName() != STYLE[1] or iterator.GetKey() in STYLE_PROPERTIES:
            yield iterator.GetKey(), iterator.GetProperty()
        iterator.Next()


def printed(proxy):
    """What the object behind a proxy prints of itself, without addresses, times and observers."""
    lines = str(proxy.GetClientSideObject()).splitlines()
    return [line for line in lines if not re.search('0x|Time|Count|Event|Command|Priority|Tag|Executive', line)]


class Proxies(unittest.TestCase):
    def test_a_name_is_the_label_without_blanks(self):
        for proxy in [new_proxy(*names) for names in PROXIES]:
            self.assertEqual(proxy.GetXMLName(), proxy.GetXMLLabel().replace(' ', ''))
        for proxy in [new_proxy(*names) for names in PROXIES + [STYLE]]:
            for name, prop in properties(proxy):
                self.assertEqual(name, prop.GetXMLLabel().replace(' ', ''), proxy.GetXMLName())

    def test_everything_is_documented(self):
        for proxy in [new_proxy(*names) for names in PROXIES]:
            text = proxy.GetDocumentation()
            for part in (text.GetDescription(), text.GetLongHelp(), text.GetShortHelp()):
                self.assertTrue(part and part.strip(), proxy.GetXMLName())
        for proxy in [new_proxy(*names) for names in PROXIES + [STYLE]]:
            for name, prop in properties(proxy):
                text = prop.GetDocumentation()
                self.assertTrue(text and text.GetDescription().strip(),
                                f'{proxy.GetXMLName()}.{name}')

    def test_defaults_of_the_proxies_are_those_of_the_classes(self):
        # Proxies without properties leave the objects as their constructors make them.
        full = [new_proxy(*names) for names in PROXIES + [STYLE]]
        classes = [proxy.GetVTKClassName() for proxy in full]
        bare = ''.join(f'<Proxy name="Bare{name}" class="{name}"/>' for name in classes)
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, 'bare.xml')
            with open(name, 'w', encoding='ascii') as file:
                file.write('<ServerManagerConfiguration><ProxyGroup name="bare">' + bare +
                           '</ProxyGroup></ServerManagerConfiguration>')
            simple.LoadPlugin(name, remote=False)
        for name, proxy in zip(classes, full):
            expected = printed(new_proxy('bare', 'Bare' + name))
            actual = printed(proxy)
            if name == 'vtkNURBSSolidRepresentation':
                expected, actual = ([line for line in lines if 'Tolerance' in line]
                                    for lines in (expected, actual))
            self.assertGreater(len(expected), 1)
            self.assertEqual(expected, actual, name)

    def test_filters_are_in_the_menu_nurbs(self):
        for proxy in [new_proxy(*names) for names in PROXIES[1:]]:
            menu = proxy.GetHints().FindNestedElementByName('ShowInMenu')
            self.assertEqual(menu.GetAttribute('category'), 'NURBS')

    def test_filters_have_icons(self):
        folder = os.path.join(os.path.dirname(common.DATA), 'Plugin')
        resources = {os.path.join(node.get('prefix'), file.text)
                     for node in ElementTree.parse(os.path.join(folder, 'Hyperpatch.qrc')).iter(
                         'qresource') for file in node}
        for proxy in [new_proxy(*names) for names in PROXIES[1:]]:
            menu = proxy.GetHints().FindNestedElementByName('ShowInMenu')
            path = f'/Hyperpatch/Icons/{proxy.GetXMLName()}.svg'
            self.assertEqual(menu.GetAttribute('icon'), ':' + path)
            self.assertIn(path, resources)
            picture = ElementTree.parse(os.path.join(folder, 'Icons', os.path.basename(path)))
            self.assertEqual(picture.getroot().get('viewBox'), '0 0 32 32')

    def test_numbers_have_sliders(self):
        for proxy in [new_proxy(*names) for names in PROXIES + [STYLE]]:
            for name, prop in properties(proxy):
                domain = prop.FindDomain('vtkSMDoubleRangeDomain')
                if name.endswith('Tolerance'):
                    self.assertTrue(domain.GetMinimumExists(0) and domain.GetMaximumExists(0))
                    low, high = domain.GetMinimum(0), domain.GetMaximum(0)
                    self.assertTrue(low <= prop.GetElement(0) <= high, proxy.GetXMLName())

    def test_filters_take_lattices_only(self):
        line = simple.Line()
        line.UpdatePipeline()
        lattice = common.open_file(common.PIPE)
        for group, name in PROXIES[1:]:
            accepts = new_proxy(group, name).GetProperty('Input').FindDomain(
                'vtkSMDataTypeDomain')
            self.assertTrue(accepts.IsInDomain(lattice.SMProxy, 0), name)
            self.assertEqual(bool(accepts.IsInDomain(line.SMProxy, 0)), name in TAKE_OTHER_DATA, name)


if __name__ == '__main__':
    unittest.main()
