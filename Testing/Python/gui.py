# SPDX-License-Identifier: BSD-3-Clause
"""Plays what a user does in the window of ParaView.

A Session collects steps: events and checks of widgets, in the form of ParaView's own test player
(paraview --test-script), and Python code to run inside. Code is played as a macro, which the menu
of macros knows from the settings folder that the session makes. What it keeps by record(name=value)
comes back from play().
"""
import json
import os
import subprocess
import tempfile
from xml.sax.saxutils import quoteattr

import common

# A session takes a quarter of that.
TIMEOUT = 120

PROPERTIES = 'propertiesDock/propertiesPanel'
PANEL = PROPERTIES + ('/scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/'
                      'PropertiesFrame/ProxyPanel')
TOLERANCE = PANEL + '/Tolerance/DoubleRangeWidget/DoubleLineEdit'
CLIP_TYPE = PANEL + '/ClipType/ProxySelectionWidget/comboBox'
BOX = PANEL + '/Box/ProxySelectionWidget/frame/ChosenProxyWidget/InteractiveBox'
PLUGINS = 'PluginManagerDialog'
# Of Qt.
KEY_PRESS = 6
KEY_RETURN = 0x01000004

# What is in the pipeline and in the view.
PIPELINE = '''
view = simple.GetActiveView()
simple.Render(view)
pipeline = {}
for (name, _), proxy in simple.GetSources().items():
    data = proxy.GetDataInformation()
    display = simple.GetDisplayProperties(proxy, view)
    pipeline[name] = [proxy.GetXMLName(), data.GetNumberOfCells(), data.GetBounds(),
                      display.Visibility, display.Representation.GetData(),
                      display.ColorArrayName.GetData()[1]]
'''

MACRO = '''
import json
from paraview import simple

def record(**values):
    with open({records!r}, 'a', encoding='ascii') as file:
        file.write(json.dumps(values) + chr(10))

{code}
'''


class Session:
    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        self.records = self.path('records')
        self.steps = []
        self.macros = []

    def path(self, *parts):
        return os.path.join(self.folder.name, *parts)

    def step(self, kind, widget, what, arguments):
        name = widget[1:] if widget.startswith('/') else 'pqClientMainWindow/' + widget
        self.steps.append(f'<{kind[0]} object={quoteattr(name)} {kind[1]}={quoteattr(what)} '
                          f'arguments={quoteattr(arguments)}/>')

    def event(self, widget, command='activate', arguments=''):
        """A widget is named by the path from the main window, a window of its own after a '/'."""
        self.step(('pqevent', 'command'), widget, command, arguments)

    def check(self, widget, name, value):
        """A property of a widget must have a value; the session fails otherwise."""
        self.step(('pqcheck', 'property'), widget, name, value)

    def python(self, code):
        name = f'macro{len(self.macros)}'
        self.macros.append((name, code))
        self.event('menubar/menu_Macros', 'activate', name)

    def load_plugin(self):
        self.event('menubar/menuTools', 'activate', 'actionManage_Plugins')
        self.event(PLUGINS + '/splitter/localGroup/loadLocal')
        self.event(PLUGINS + '/pqFileDialog', 'filesSelected', os.environ['HYPERPATCH_PLUGIN'])
        self.event(PLUGINS + '/buttonBox/1QPushButton0')

    def open(self, file, several_readers=False):
        self.event('menubar/menu_File', 'activate', 'actionFileOpen')
        self.event('FileOpenDialog', 'filesSelected', file)
        if several_readers:  # ours is the one that is offered
            self.event('pqSelectReaderDialog/okButton')

    def source(self, name):
        self.event('menubar/menuSources/NURBS', 'activate', name)

    def filter(self, name):
        self.event('menubar/menuFilters/NURBS', 'activate', name)

    def quick_launch(self, typed, found):
        """What Ctrl+Space opens: types, and takes the first that is found."""
        self.event('menubar/menuFilters', 'activate', 'Search...\tCtrl+Space')
        for character in typed:
            self.event('QuickLaunchDialog', 'keyEvent',
                       f'{KEY_PRESS}:{ord(character.upper())}:0:{character}:0:1')
        self.check('QuickLaunchDialog/selection', 'text', found)
        self.check('QuickLaunchDialog/selection', 'enabled', 'true')
        self.event('QuickLaunchDialog', 'keyEvent', f'{KEY_PRESS}:{KEY_RETURN}:0::0:1')

    def add_values(self, name, first, last):
        """Two values more in a list of values, by the dialog that makes a series of them."""
        values = f'{PANEL}/{name}/ScalarValueList'
        dialog = values + '/SeriesGeneratorDialog'
        self.event(values + '/AddRange')
        self.event(dialog + '/min', 'set_string', str(first))
        self.event(dialog + '/max', 'set_string', str(last))
        self.event(dialog + '/nsamples', 'set_int', '2')
        self.event(dialog + '/buttonBox/1QPushButton0')

    def apply(self):
        self.event(PROPERTIES + '/Accept')

    def color_by(self, entry):
        self.event('variableToolbar/displayColor/Variables', 'set_string', entry)

    def play(self):
        """Starts ParaView; returns what was recorded. Fails if a step does."""
        settings = self.path('.config', 'ParaView', 'Macros')
        os.makedirs(settings)
        for name, code in self.macros:
            with open(os.path.join(settings, name + '.py'), 'w', encoding='ascii') as file:
                file.write(MACRO.format(records=self.records, code=code))
        script = self.path('script.xml')
        with open(script, 'w', encoding='ascii') as file:
            file.write('<pqevents>\n' + '\n'.join(self.steps) + '\n</pqevents>\n')
        # pvpython is an MPI process itself, and says so in the environment.
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith(('OMPI_', 'ORTE_', 'PMIX_'))}
        environment.update(HOME=self.folder.name, XDG_CONFIG_HOME=self.path('.config'))
        with open(self.path('output'), 'w+', encoding='utf-8') as output:
            process = subprocess.Popen(
                [os.environ.get('PARAVIEW', 'paraview'), '--dr', f'--test-script={script}',
                 f'--test-directory={self.folder.name}', f'--data-directory={common.DATA}',
                 '--exit'], env=environment, stdout=output, stderr=subprocess.STDOUT)
            try:
                process.wait(TIMEOUT)
            except subprocess.TimeoutExpired:  # a dialog waits for an answer
                process.kill()
                process.wait()
            output.seek(0)
            said = ''.join(line for line in output if 'Available widget' not in line)
        assert process.returncode == 0 and 'Success =  true' in said, said
        result = {}
        with open(self.records, encoding='ascii') as file:
            for line in file:
                result.update(json.loads(line))
        return result

    def start_trace(self):
        self.python('from paraview import smtrace; smtrace.start_trace()')

    def stop_trace(self):
        self.python('from paraview import smtrace\n'
                    f"with open({self.path('trace.py')!r}, 'w', encoding='utf-8') as file:\n"
                    '    file.write(smtrace.stop_trace())')

    def replay_trace(self):
        """The pipeline that pvpython makes of the trace, as PIPELINE tells it. After play()."""
        with open(self.path('trace.py'), 'a', encoding='utf-8') as file:
            file.write(f'\nfrom paraview import simple\n{PIPELINE}\nimport json\n'
                       f"json.dump(pipeline, open({self.path('replayed')!r}, 'w'))\n")
        subprocess.run([common.PVPYTHON, file.name], check=True, timeout=TIMEOUT)
        with open(self.path('replayed'), encoding='ascii') as file:
            return json.load(file)
