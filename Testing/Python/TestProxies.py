# SPDX-License-Identifier: BSD-3-Clause
"""What state files, scripts and panels rely on: names, documentation and defaults."""
import os
import re
import tempfile
import unittest
from xml.etree import ElementTree

from paraview import servermanager, simple


def definitions():
    """Groups and names of all proxies that there are now."""
    result = set()
    for group in ('sources', 'filters', 'writers'):
        iterator = servermanager.ProxyManager().NewDefinitionIterator(group)
        result |= {(group, iterator.GetProxyName()) for _ in iterator}
    return result


STOCK = definitions()
import common  # loads the plugin

# All that the plugin brings.
PROXIES = sorted(definitions() - STOCK)
STYLE = ('representations', 'NURBSSolidRepresentation')
STYLE_PROPERTIES = ('SolidTolerance', 'SolidAttributeTolerance')


def new_proxy(group, name):
    proxy = servermanager.ProxyManager().SMProxyManager.NewProxy(group, name)
    proxy.UpdateVTKObjects()
    return proxy


def in_menus():
    """What the plugin brings but for readers and writers."""
    for names in PROXIES:
        proxy = new_proxy(*names)
        hints = proxy.GetHints()
        if names[0] != 'writers' and not (hints and hints.FindNestedElementByName('ReaderFactory')):
            yield proxy


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
    def test_all_that_is_known_is_found(self):
        known = {'BSplineReader', 'NURBSContour', 'NURBSExtractPatches', 'NURBSJacobianBoundary',
                 'NURBSSlice', 'NURBSTessellate'}
        self.assertEqual(known - {name for _, name in PROXIES}, set())

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

    def test_everything_is_in_the_menu_nurbs(self):
        for proxy in in_menus():
            menu = proxy.GetHints().FindNestedElementByName('ShowInMenu')
            self.assertEqual(menu.GetAttribute('category'), 'NURBS', proxy.GetXMLName())

    def test_everything_has_an_icon(self):
        folder = os.path.join(os.path.dirname(common.DATA), 'Plugin')
        resources = {os.path.join(node.get('prefix'), file.text)
                     for node in ElementTree.parse(os.path.join(folder, 'Hyperpatch.qrc')).iter(
                         'qresource') for file in node}
        for proxy in in_menus():
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

    def test_filters_on_lattices_take_nothing_else(self):
        line, image = simple.Line(), simple.Wavelet()
        lattice = common.open_file(common.PIPE)
        for source in (line, image):
            source.UpdatePipeline()
        checked = 0
        for proxy in in_menus():
            prop = proxy.GetProperty('Input')
            domain = prop.FindDomain('vtkSMDataTypeDomain') if prop else None
            # A filter that fits splines to data of any kind is no filter on lattices.
            if domain and domain.IsInDomain(lattice.SMProxy, 0) and \
                    not domain.IsInDomain(image.SMProxy, 0):
                checked += 1
                self.assertFalse(domain.IsInDomain(line.SMProxy, 0), proxy.GetXMLName())
        self.assertGreaterEqual(checked, 5)


if __name__ == '__main__':
    unittest.main()
