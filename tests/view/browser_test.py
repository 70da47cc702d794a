"""The page of plumb view in a headless browser: every slider, hands, replays; screenshots go to the build folder."""
import json
import os
import re
import shutil
import subprocess
import sys
import time

SKIPPED = 77
PATIENCE = 120  # seconds: a machine that also compiles draws a frame in as many as five


def skip(reason):
    print("skipped:", reason)
    sys.exit(SKIPPED)


try:
    from selenium import webdriver
    from selenium.common.exceptions import TimeoutException, WebDriverException
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    skip("python3-selenium is missing; tools/setup --browser installs it")

# Where a particle is on the page, in CSS pixels from the middle of the canvas.
PLACE = """const p = window.plumb.painter, port = p.viewports()[0], s = window.plumb.frame.sides[0].positions;
const c = document.getElementById("view"), k = 3 * arguments[0];
const at = window.plumb.camera.project([s[k], s[k + 1], s[k + 2]], port.width, port.height);
const scale = c.width / c.clientWidth;
return [(port.x + at.x) / scale - c.clientWidth / 2, (port.y + at.y) / scale - c.clientHeight / 2];"""


def resize(browser, width, height):
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})


def set_scheme(browser, dark):
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
        "features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})


def start_browser(dark, width, height):
    options = Options()
    options.binary_location = shutil.which("chromium")
    for argument in ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars"]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    try:
        browser = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    except WebDriverException as error:
        skip("chromium does not start: " + str(error).splitlines()[0])
    resize(browser, width, height)
    set_scheme(browser, dark)
    return browser


def wait_until(condition, what, tell):
    """Returns what the condition gives as soon as it holds."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if holds := condition():
            return holds
        time.sleep(0.05)
    raise AssertionError("in vain waited until " + what + "; " + tell())


def take_picture(browser, file):
    """Takes a picture to look at, unless the machine is too busy to draw one in the driver's ten seconds."""
    try:
        browser.save_screenshot(file)
    except TimeoutException:
        print("no picture in time:", file)


class View:
    """A server and what a browser sees of it."""

    def __init__(self, plumb, browser, *arguments):
        self.process = subprocess.Popen([plumb, "view", *arguments], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        self.browser = browser
        browser.get(self.process.stdout.readline().strip())
        self.until("window.plumb?.frame?.frame > 3", "frames come")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.browser.get("about:blank")
        self.process.terminate()
        self.process.wait()

    def js(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def until(self, condition, what):
        # A page that has been told of other worlds has no frame until theirs comes.
        known = "window.plumb.frame && " if "plumb.frame." in condition else ""
        wait_until(lambda: self.js(f"return Boolean({known}({condition}))"), what,
                   lambda: "note: " + str(self.js("return document.getElementById('note')?.textContent")))

    def click(self, element):
        self.browser.find_element(By.ID, element).click()

    def frame(self, part):
        """Returns a part of the frame that is shown, as soon as there is one: worlds that begin anew have none."""
        return wait_until(lambda: self.js(f"return window.plumb?.frame && [window.plumb.frame.{part}]"), "a frame is shown",
                          lambda: part)[0]

    def goes_on(self):
        self.until(f"window.plumb.frame.frame !== {self.frame('frame')}", "frames go on")

    def note(self):
        return self.js("const n = document.getElementById('note'); return n.hidden ? '' : n.textContent")

    def severe(self):
        return [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]

    def pause(self, paused=True):
        if self.frame("playing") == paused:
            self.click("play")
        self.until(f"window.plumb.frame.playing === {'false' if paused else 'true'}", "it plays or stands")


def check_sliders_of_tab(view):
    names = view.js("return [...document.querySelectorAll('input[type=range]:not(:disabled)')].map(e => e.id)")
    for name in names:
        kept = view.js("return document.getElementById(arguments[0]).value", name)
        for value in [view.js("return document.getElementById(arguments[0]).max", name), "0", kept]:
            view.js("const e = document.getElementById(arguments[0]); e.value = arguments[1];"
                    "e.dispatchEvent(new Event('input'))", name, value)
            view.goes_on()
        assert view.frame("sides.every(s => s.positions.every(Number.isFinite))"), name
    return names


def check_sliders(view):
    """Every slider of every world goes to both ends and back, and worlds go on."""
    moved = set()
    for tab in range(len(view.frame("sides"))):
        view.js("document.querySelectorAll('#tabs [role=tab]')[arguments[0]].click()", tab)
        moved |= set(check_sliders_of_tab(view))
    view.js("document.querySelector('#tabs [role=tab]').click()")
    every = view.js("return [...document.querySelectorAll('input[type=range]')].map(e => e.id)")
    assert moved == set(every) and "set-gravity" in moved, (moved, every)


def check_end_mass(view):
    """Who moves the first slider sees why weights by mass matter, also at its end."""
    for value in ["max", "value"]:
        view.js("const e = document.getElementById('set-end_mass'); e.dataset.kept ??= e.value;"
                "e.value = arguments[0] === 'max' ? e.max : e.dataset.kept;"
                "for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind))", value)
        view.until("window.plumb.frame.frame < 30", "worlds start again")
        says = "/^(By mass stays near the reference. Equal was up to|Lately b)/"
        view.until(f"{says}.test(document.getElementById('verdict').textContent)", "the page says what is seen")
        check_why(view, 1000 if value == "max" else 10)


def check_why(view, end_mass):
    """A picture in the header says how a correction is shared, and is gone where worlds are not compared by weights."""
    drawn = "document.querySelector('#why svg').getAttribute('aria-label')"
    share = {10: "1 kg takes 91 % of the way and 10 kg takes 9 %", 1000: "1 kg takes 99.9 % of the way and 1000 kg takes 0.1 %"}
    view.until(f"{drawn}.startsWith('By mass, {share[end_mass]}')", "the picture follows the slider")
    view.until(f"{drawn}.endsWith('{end_mass} kg is moved like 1 kg.')", "it says what equal weights do")
    width, height, bottom = view.js("const box = document.getElementById('why').getBoundingClientRect();"
                                    "return [box.width, box.height, box.bottom]")
    assert 300 <= width <= 400 and height <= 115 and bottom < 300, (width, height, bottom)


def check_verdict(view):
    """What is said of worlds holds for the numbers beside it, also where these change from moment to moment."""
    says = """return import("./measured/verdict.js").then(({ verdict }) => verdict(
        ["direct", "mass", "equal"].map((weights) => ({ name: weights, settings: { method: "relax", weights } })),
        [[], ...arguments[0].map(([past, now]) => [...Array(99).fill(past), now])], arguments[1], null, false))"""
    alike, differ = {"least": 1, "most": 1, "end": 1}, {"least": 1, "most": 10, "end": 10}
    for worlds, masses, said in [([[0.5, 5.1], [40, 60]], differ, "Lately mass was up to 5.1 % off, equal up to 60 % off. "),
                                 ([[0.5, 0.6], [40, 4.6]], differ, "Mass stays near the reference. Equal was up to 40 % off."),
                                 ([[6, 6], [6, 9.5]], alike, "All masses are alike, but small differences have grown."),
                                 ([[6, 6], [6, 6.1]], alike, "All masses are alike: weights make no difference.")]:
        assert view.js(says, worlds, masses) == said.strip(), (said, view.js(says, worlds, masses))
    says = """return import("./measured/verdict.js").then(({ verdict }) => verdict(
        ["truth", "direct", "relaxed"].map((name) => ({ name })), [[], ...arguments[0].map((at) => Array(99).fill(at))], {}, null, false))"""
    assert view.js(says, [0.1, 40]) == "" and view.js(says, [12, 11]).startswith("Motions have parted"), "errors are so while motions are near"


# Pairs of what a selector finds that cover each other, as texts or names.
COVERED = """const boxes = [...document.querySelectorAll(arguments[0])].map(e => [e.textContent.trim() || e.id, e.getBoundingClientRect()])
  .filter(([, box]) => box.width > 0);
return boxes.flatMap(([a, p], i) => boxes.slice(i + 1).filter(([, q]) =>
  p.left < q.right - 0.5 && q.left < p.right - 0.5 && p.top < q.bottom - 0.5 && q.top < p.bottom - 0.5).map(([b]) => a + " | " + b));"""


def check_labels(view):
    """Words of the picture, and names of worlds side by side, cover nothing; in a plot that is high its line keeps its name."""
    for pair in [[1.16, 0.905], [1.16, 1000], [0.123, 0.0456]]:
        view.js("""return import("./measured/why.js").then(({ showWhy }) => showWhy(document.getElementById("why"),
                   ["direct", "mass", "equal"].map((weights) => ({ settings: { method: "relax", weights } })),
                   { next: arguments[0] }, arguments[1]))""", *pair)
        assert not (covered := view.js(COVERED, "#why text")), (pair, covered)
    view.click("overlay")
    view.until("document.querySelectorAll('#titles span').length === 3", "worlds are named")
    assert not (covered := view.js(COVERED, "#titles span, #tools, #transport, header")), covered
    view.click("overlay")
    line = view.js("""return import("./measured/plots.js").then(({ makePlots }) => {
        const { time } = makePlots((id) => document.getElementById(id)), pen = CanvasRenderingContext2D.prototype, old = pen.fillText;
        let at = 0;
        pen.fillText = (text, x, y) => { if (text === "16.7 ms") at = y; };
        time.add([500]);
        time.draw();
        pen.fillText = old;
        return [at, time.canvas.clientHeight];
      });""")
    assert 10 < line[0] < line[1], line


def check_low(view):
    """In a window that is low nothing lies over something else or off the edge, and controls open beside the view."""
    bars = "header > *, #tools, #winch, #time, #transport, #panel"
    off = """return [...document.querySelectorAll("button, select, header > *")].map(e => [e.id, e.getBoundingClientRect()])
      .filter(([, box]) => box.width && (box.left < 0 || box.right > innerWidth)).map(([id]) => id)"""
    resize(view.browser, 844, 390)
    view.until("!document.getElementById('why').open", "the picture folds")
    for is_open in [False, True]:
        view.click("fold")
        view.until(f"document.getElementById('view').clientWidth {'<' if is_open else '>'} 600", "controls open or close")
        assert not (covered := view.js(COVERED, bars)) and not view.js(off), (covered, view.js(off))
    resize(view.browser, 1280, 720)


def check_tabs(view):
    """A world that is added is the one that settings are of, and a button that is off says why."""
    view.browser.find_element(By.XPATH, "//*[@id='tabs']//button[.='+']").click()
    view.until("document.querySelectorAll('#legend b').length === 4", "there is one more")
    tabs, more = view.js("return ['[role=tab]', 'span button'].map(s => [...document.querySelectorAll('#tabs ' + s)])")
    assert [tab.get_attribute("aria-selected") for tab in tabs] == 3 * ["false"] + ["true"]
    assert "four" in more[0].get_attribute("title") and view.js("return document.getElementById('about').textContent")
    more[1].click()
    view.until("document.querySelectorAll('#legend b').length === 3", "it is gone")
    view.js("document.querySelectorAll('#tabs [role=tab]')[1].click()")


# The colours of the pixels along a line across the end of the first world, from the outside in, without repetitions.
ACROSS = """const { painter } = window.plumb, { gl, canvas } = painter, draw = painter.draw;
const [x, y] = arguments[0], ratio = canvas.width / canvas.clientWidth, seen = [];
return new Promise((done) => {
  painter.draw = (camera) => {
    draw.call(painter, camera);
    painter.draw = draw;
    const row = new Uint8Array(4 * 61);
    gl.readPixels(canvas.width / 2 + ratio * x - 60, canvas.height / 2 - ratio * y, 61, 1, gl.RGBA, gl.UNSIGNED_BYTE, row);
    for (let i = 0; i < 61; ++i) {
      const [r, g, b] = row.subarray(4 * i, 4 * i + 3);
      seen.push(r > g + 50 ? "orange" : b > g + 50 ? "blue" : g > b + 20 ? "green" : Math.max(r, g, b) - Math.min(r, g, b) < 40 ? "grey" : "");
    }
    done(seen.filter((name, i) => name && name !== seen[i - 1]));
  };
  window.plumb.camera.orbit(1, 0);
});"""


def check_over_each_other(view):
    """Worlds that lie in one place are all seen: each is thinner than the one before."""
    view.js("const { page, requests } = window.plumb; page.send(requests.compare('one world'))")
    for count in [1, 2, 3]:
        view.until(f"window.plumb.frame.sides.length === {count}", "there are so many")
        view.browser.find_element(By.XPATH, "//*[@id='tabs']//button[.='+']").click()
    view.until("window.plumb.frame.sides.length === 4", "there are four")
    view.pause()
    view.until("document.getElementById('clock').textContent.includes('frame')", "it is drawn")
    end = view.frame("sides[0].positions.length / 3 - 1")
    view.js("const { camera, frame } = window.plumb, p = frame.sides[0].positions, k = 3 * arguments[0];"
            "camera.zoom(0.2); camera.target = [p[k], p[k + 1], p[k + 2]]", end)
    seen = view.js(ACROSS, view.js(PLACE, end))
    view.js("window.plumb.camera.frame(window.plumb.painter.model)")
    assert [name for name in seen if name != "grey"] == ["blue", "orange", "green"], seen
    view.js("window.plumb.page.send(window.plumb.requests.compare('mass against equal'))")
    view.until("window.plumb.frame.sides.length === 3", "it is the comparison again")
    view.pause(False)
    view.js("document.querySelectorAll('#tabs [role=tab]')[1].click()")


def check_words(view):
    """Every control and every choice is explained, also to who sees nothing; what has the focus is explained in its place."""
    plain = view.js("""return [...document.querySelectorAll('#panel :is(input, select, figure, #defaults, #tabs span button)')]
      .filter(e => !document.getElementById(e.getAttribute('aria-describedby'))?.textContent).map(e => e.outerHTML)""")
    assert not plain, plain
    plain = view.js("return [...document.querySelectorAll('#panel option')].filter(e => e.value && !e.text.includes(': ')).map(e => e.text)")
    assert not plain, plain
    place = "return document.getElementById('explained').textContent"
    view.js("document.getElementById('set-weights').focus()")
    assert "share its correction. mass: the lighter" in view.js(place), view.js(place)
    ActionChains(view.browser).send_keys(Keys.TAB).perform()
    assert "1/60 s" in view.js(place), view.js(place)
    ActionChains(view.browser).move_to_element(view.browser.find_element(By.ID, "plot-strain")).perform()
    assert "worst rod" in view.js(place), view.js(place)
    assert "starts all again" in view.js("return document.getElementById('tabs').textContent"), "+ and − say so before"
    sweeps = view.browser.execute_cdp_cmd("Runtime.evaluate", {"expression": "document.getElementById('set-sweeps')"})
    told = view.browser.execute_cdp_cmd("Accessibility.queryAXTree", {"objectId": sweeps["result"]["objectId"]})
    assert "goes over all rods" in told["nodes"][0]["description"]["value"], told


def check_names(view):
    """A world is called what it is now, in the legend and on its tab; the words and the picture of a comparison that is over go."""
    name = "document.querySelectorAll('#legend b')[1].textContent"
    view.js("document.querySelectorAll('#tabs [role=tab]')[1].click()")
    for weights, now in [("equal", "by mass · weights equal"), ("mass", "by mass")]:
        view.js("const s = document.getElementById('set-weights'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", weights)
        view.until(f"{name} === '{now}'", "the legend says what it is")
        view.until(f"document.querySelectorAll('#tabs [role=tab]')[1].textContent === '{now}'", "its tab does")
        is_compared = "true" if weights == "mass" else "false"
        view.until(f"document.getElementById('about').textContent.includes('The pale reference') === {is_compared}", "the intro is true")
        view.until(f"document.getElementById('why').hidden !== {is_compared}", "so is the picture")


def check_hands(view):
    canvas = view.browser.find_element(By.ID, "view")
    last = view.frame("sides[0].positions.length / 3 - 1")
    view.pause()  # what swings is hard to hit
    x, y = view.js(PLACE, last)
    before = view.frame(f"sides[0].positions[{1 + 3 * last}]")
    actions = ActionChains(view.browser, duration=50).move_to_element_with_offset(canvas, int(x), int(y)).click_and_hold()
    actions.perform()
    view.until(f"window.plumb.painter.held === {last}", "the end is held")
    assert view.note().startswith("Paused: this moves once worlds play"), view.note()
    view.js("window.plumb.page.send(window.plumb.requests.play())")
    actions = ActionChains(view.browser, duration=50)
    for _ in range(6):
        actions = actions.move_by_offset(0, -20)
    actions.perform()
    view.until(f"window.plumb.frame.sides[0].positions[{1 + 3 * last}] > {before}", "the end is lifted")
    ActionChains(view.browser).release().perform()
    view.until("window.plumb.painter.held < 0", "the hand lets go")

    view.pause()
    for tool, aim in [("fix", "particle"), ("reel", "rod"), ("cut", "rod")]:
        view.browser.find_element(By.CSS_SELECTOR, f"[data-tool={tool}]").click()
        ActionChains(view.browser, duration=50).move_to_element_with_offset(canvas, 400, -300).click().perform()
        assert view.note() == f"No {aim} there: click closer to one.", (tool, view.note())
    (ax, ay), (bx, by) = view.js(PLACE, last - 6), view.js(PLACE, last - 7)
    ActionChains(view.browser).move_to_element_with_offset(canvas, int((ax + bx) / 2), int((ay + by) / 2)).click().perform()
    view.until("window.plumb.frame.sides.every(s => s.gone.length === 1)", "a rod is cut in all worlds")
    assert not view.note(), "a hit takes back what was said of a miss"
    view.browser.find_element(By.CSS_SELECTOR, "[data-tool=pull]").click()


def check_figure(view):
    """A limb is pulled, and thrown balls are alike, and each one particle more."""
    canvas = view.browser.find_element(By.ID, "view")
    view.until("window.plumb.frame.sides[0].awake === 0", "the figure sleeps")
    view.js("document.getElementById('colour').value = 'sleep';"
            "document.getElementById('colour').dispatchEvent(new Event('change'))")
    view.until("document.getElementById('key').textContent.includes('asleep')", "colours are explained")
    view.until("document.getElementById('counters').textContent.includes('0 / 1')", "what sleeps is counted")
    view.pause()
    x, y = view.js(PLACE, 0)
    ActionChains(view.browser, duration=50).move_to_element_with_offset(canvas, int(x), int(y)).click_and_hold().perform()
    view.until("window.plumb.painter.held >= 0", "a limb is held")
    view.js("window.plumb.page.send(window.plumb.requests.play())")
    ActionChains(view.browser, duration=50).move_by_offset(40, 30).move_by_offset(40, 30).perform()
    view.until("window.plumb.frame.sides[0].awake === 1", "the figure wakes")
    ActionChains(view.browser).release().perform()
    before = view.frame("sides[0].positions.length")
    view.browser.find_element(By.CSS_SELECTOR, "[data-tool=throw]").click()
    view.js("const { page } = window.plumb, send = page.send; window.sizes = [];"
            "page.send = (m) => { window.sizes.push(JSON.parse(m).value); send(m); }")
    for balls in [1, 2]:
        ActionChains(view.browser).move_to_element_with_offset(canvas, 20, 20).click().perform()
        view.until(f"window.plumb.frame.sides[0].positions.length === {before + 3 * balls}", "a ball flies")
    first, second = view.js("return window.sizes")
    assert first == second, (first, second)
    view.js("window.plumb.page.send(window.plumb.requests.load('winch'))")
    view.until("window.plumb.page.hands.tool === 'pull'", "where nothing can be hit, the tool is another one")
    assert view.js("return document.querySelector('#tools [aria-pressed=true]').textContent") == "Pull"
    ActionChains(view.browser).send_keys("5").perform()
    assert view.note().startswith("Nothing in this scene"), view.note()


def check_colours(view):
    """Every choice of colours is drawn and explained."""
    for name, text in [("strain", "%"), ("tension", "N"), ("island", "island ("), ("color", "graph ("), ("lane", "lane (")]:
        view.js("const c = document.getElementById('colour'); c.value = arguments[0]; c.dispatchEvent(new Event('change'))", name)
        view.until(f"document.getElementById('key').textContent.includes('{text}')", name + " is explained")
        view.goes_on()
    tints = view.js("return [...window.plumb.painter.sides[0].stickTints.slice(0, 12)].join()")
    view.js("const c = document.getElementById('colour'); c.value = 'world'; c.dispatchEvent(new Event('change'))")
    view.until("[...window.plumb.painter.sides[0].stickTints.slice(0, 12)].join() !== '" + tints + "'", "colours change")
    assert "solve" in view.js("return document.getElementById('stages').textContent"), "times of stages are shown"


def check_trails(view):
    """A trail passes through where its end was, is no chord between, keeps a corner where there was a blow, and ends at what is shown."""
    off = view.js("""return import("./drawn/trail.js").then(({ smooth }) => {
        const at = (f) => [Math.cos(0.4 * f), Math.sin(0.4 * f), 0], way = [0, 1, 2, 4, 5, 6].map((frame) => ({ frame, at: at(frame) }));
        const curve = smooth(way), least = (p) => Math.min(...curve.map((q) => Math.hypot(p[0] - q[0], p[1] - q[1])));
        const blow = smooth([[0, 2], [1, 1], [2, 0], [3, 1], [4, 2]].map(([x, y], frame) => ({ frame, at: [x, y, 0] })));
        return [Math.max(...way.map((p) => least(p.at))), least(at(1.5)), least(at(3)), Math.min(...blow.map((p) => p[1]))];
      });""")
    assert off[0] < 1e-9 and off[1] < 0.004 and off[2] < 0.03 and off[3] >= 0, off


def check_plots(view):
    """Rounding is drawn flat: scales do not follow it."""
    ranges = view.js("""const { makePlots } = await import("./measured/plots.js");
        const plots = makePlots((id) => document.getElementById(id));
        plots.energy.least = 1e-4;
        return Object.fromEntries(Object.entries(plots).map(([name, plot]) => {
          plot.add([1e-14, 3e-15]);
          plot.add([2e-14, name === "energy" ? -1e-15 : 0]);
          return [name, plot.range()];
        }));""")
    assert ranges["distance"][1] >= 0.01 and ranges["time"][1] > 16, ranges
    assert ranges["energy"][1] - ranges["energy"][0] >= 1e-4, ranges
    low, high = ranges["strain"]
    assert low >= -10 and high >= -6, ranges


# How far the farthest point of what is drawn in the first world is from the middle of the view, in half its size.
FARTHEST = """const { painter, camera, frame } = window.plumb, { model } = painter, [port] = painter.viewports();
const points = frame.sides[0].positions, radii = new Map(model.spheres);
let out = 0;
for (let i = 0; i < model.particles; ++i) {
  if (arguments[0] && !painter.whatStays()[i]) continue;
  for (const axis of [0, 1, 2])
    for (const sign of [-1, 1]) {
      const at = [0, 1, 2].map((c) => points[3 * i + c] + (c === axis ? sign * (radii.get(i) ?? 0) : 0));
      const { x, y } = camera.project(at, port.width, port.height);
      out = Math.max(out, Math.abs(2 * x / port.width - 1), Math.abs(2 * y / port.height - 1));
    }
}
return out"""


def until_seen(view, stays, most, what):
    """The view follows in a while: all, or what `stays`, is within so much of half its size."""
    wait_until(lambda: view.js(FARTHEST, stays) < most, f"the view shows {what}", lambda: str(view.js(FARTHEST, stays)))


def check_framing(plumb, browser):
    """What moves is seen whole, and is not lost where it is fast."""
    for scene, most in [("humanoid:body=medium", 0.85), ("drop", 0.95), ("shot", 1)]:
        with View(plumb, browser, scene) as view:
            view.until("window.plumb.frame.frame > 40", "it has moved")
            view.pause()
            until_seen(view, False, most, scene)
            high = "document.getElementById('high').textContent"
            if scene == "shot":
                view.until(f"/ m above the ground; marks are .* m apart/.test({high})", "what flies out of sight has marks")
            else:
                view.until(f"!{high}", scene + " needs no marks")
            thick = view.js("return 0.6 * window.plumb.painter.model.rodRadius / window.plumb.painter.model.radius")
            assert thick < 0.05, (scene, "a trail covers nothing", thick)


def check_scattered(view):
    """Where things flew apart, the view stays with most of them, and counts from where they began."""
    view.until("document.getElementById('high').textContent.includes('where it began')", "it says how far it went")
    view.until("window.plumb.frame.frame > 100", "they flew apart")
    view.pause()
    wait_until(lambda: view.js(SEEN) > 0.5, "most is seen", lambda: str(view.js(SEEN)))


# Which share of the first world's particles is in the view.
SEEN = """const { painter, camera, frame } = window.plumb, [port] = painter.viewports(), points = frame.sides[0].positions;
let seen = 0;
for (let i = 0; i < points.length; i += 3) {
  const at = camera.project(points.slice(i, i + 3), port.width, port.height);
  seen += at && at.x > 0 && at.x < port.width && at.y > 0 && at.y < port.height;
}
return 3 * seen / points.length"""


def check_cut_view(view):
    """The view stays with what hangs on, not with what was cut off and falls."""
    view.click("reset")
    view.pause(False)
    view.js("window.plumb.page.send(window.plumb.requests.cut(10))")
    view.until("window.plumb.frame.sides[0].gone.length === 1 && window.plumb.frame.frame > 240", "a part fell")
    until_seen(view, True, 1, "what hangs on")
    kept = view.js("return window.plumb.painter.whatStays().filter(Boolean).length")
    assert kept == 11, kept


# Plays a recording from its start while every picture takes so many ms more. Returns how many seconds of it were shown,
# how many passed, and the longest time between pictures. What the page leaves out where it stood still does not count.
FILM_CLOCK = """const { page, requests } = window.plumb, [busy] = arguments;
for (const ask of [requests.reset(), requests.speed(1), requests.play()]) page.send(ask);
return new Promise((done) => {
  let first = null, last = 0, passed = 0, most = 0;
  const watch = (now) => {
    const { time } = window.plumb.frame, gap = Math.min(1000, now - last);
    if (first === null) first = time;
    else [passed, most] = [passed + gap, Math.max(most, gap)];
    last = now;
    if (passed > 2500) return done([time - first, passed / 1000, most / 1000]);
    for (const end = performance.now() + busy; performance.now() < end;);
    requestAnimationFrame(watch);
  };
  requestAnimationFrame(watch);
});"""


def check_film_slider(view):
    """A slider shows where the recording is, and moves in it by keys and by a pointer."""
    slider = view.browser.find_element(By.ID, "place")
    shows = "Number(document.getElementById('place').value)"
    count = view.js("return Number(document.getElementById('place').max)")
    assert count > 200 and slider.get_attribute("aria-label") == "Place in the recording"
    view.js("const { page, requests } = window.plumb; page.send(requests.pause()); page.send(requests.reset())")
    begin = view.frame("time")
    assert view.js("return " + shows) == 0
    slider.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    view.until(f"{shows} === 2", "arrow keys go from frame to frame")
    said = f"{view.frame('time') - begin:.2f} s of "
    assert slider.get_attribute("aria-valuetext").startswith(said) and said > "0.02", (said, slider.get_attribute("aria-valuetext"))
    view.js("window.plumb.page.send(window.plumb.requests.play())")
    width = slider.size["width"]
    ActionChains(view.browser, duration=50).move_to_element_with_offset(slider, width // 4, 0).click_and_hold().perform()
    held, frame = view.js("return " + shows), view.frame("frame")
    assert 0.6 < held / count < 0.9, (held, count)
    time.sleep(0.5)
    assert [view.js("return " + shows), view.frame("frame")] == [held, frame], "it stays where it is held"
    ActionChains(view.browser).release().perform()
    view.until(f"{shows} !== {held}", "it goes on once it is let go")
    view.js("window.plumb.page.send(window.plumb.requests.pause())")
    # The browser takes a drag in pieces for a click.
    actions = ActionChains(view.browser, duration=50).move_to_element_with_offset(slider, width // 4, 0).click_and_hold()
    actions.move_by_offset(-width // 2, 0).pause(0.2).release().perform()
    view.until(f"{shows} < {0.4 * count} && {shows} > {0.1 * count}", "it goes where it is drawn to")
    view.js("window.plumb.page.send(window.plumb.requests.play())")
    view.goes_on()


def check_film(view, folder):
    """A saved page shows what was seen, from a file and without a server."""
    view.js("window.saved = null")
    view.click("film")
    view.until("window.saved", "a page is saved")
    text = view.js("return window.saved")
    assert not re.findall(r"<link|\bsrc=|href=", text.split("<script", 1)[0]), "it has no links"
    file = os.path.join(folder, "film.html")
    with open(file, "w", encoding="utf-8") as out:
        out.write(text)
    shown = view.frame("sides[0].positions.length")
    view.browser.get("file://" + os.path.abspath(file))
    view.until("window.plumb?.frame", "the recording is shown")
    check_film_slider(view)
    # A picture that takes long does not slow the recording down: frames are left out.
    for busy in [0, 150]:
        shown_s, passed_s, gap_s = view.js(FILM_CLOCK, busy)
        assert abs(shown_s - passed_s) < gap_s + 0.05, ("it keeps to the clock", shown_s, passed_s, gap_s)
    view.js("window.plumb.page.send(window.plumb.requests.speed(10))")
    view.until("/^Recording of .* s, ended$/.test(document.getElementById('pace').textContent)", "it says that it has ended")
    assert view.frame("sides[0].positions.length") == shown
    view.click("ask")
    said = view.js("return document.body.innerText")  # of what is seen
    assert "shows a recording" in said and "The pale reference solves all at once" in said, said
    assert not (asks := re.findall("Move End mass|Make the end|sliders|[Rr]eel in|dropped|Defaults", said)), asks
    view.js("document.getElementById('help').close()")
    take_picture(view.browser, os.path.join(folder, "film.png"))


def drop_letter(view):
    """Drops what is no scene. Returns whether the page says so at once, before other news."""
    view.js("const d = new DataTransfer(); d.items.add(new File(['élan vital'], 'letter.txt'));"
            "dispatchEvent(new DragEvent('drop', { dataTransfer: d }))")
    time.sleep(0.2)
    return "letter.txt" in view.note()


def check_refusals(view):
    """What is no scene, a second page and a server that is gone are told in words."""
    wait_until(lambda: drop_letter(view), "a letter is no scene", view.note)
    view.goes_on()
    first, address = view.browser.current_window_handle, view.browser.current_url
    view.browser.switch_to.new_window("tab")
    view.browser.get(address)
    view.until("document.getElementById('note').textContent.includes('Another page')", "the second page is told")
    view.until("window.plumb.painter", "it can draw")
    view.js("const p = window.plumb.painter, old = p.draw; p.draw = (c) => { old.call(p, c); const pixel = new Uint8Array(4);"
            "p.gl.readPixels(9, 9, 1, 1, p.gl.RGBA, p.gl.UNSIGNED_BYTE, pixel); window.corner = [...pixel]; };"
            "window.plumb.camera.orbit(1, 0)")
    assert wait_until(lambda: view.js("return window.corner"), "it draws its background", view.note)[0] > 200
    view.browser.find_element(By.CSS_SELECTOR, "#note button").click()
    view.until("window.plumb?.frame?.frame > 3", "it takes over")
    view.goes_on()
    assert not view.note() and not view.js("return document.getElementById('tools').inert")
    second = view.browser.current_window_handle
    view.browser.switch_to.window(first)
    view.until("document.getElementById('note').textContent.includes('another tab now')", "the first page is told")
    time.sleep(1)  # in which it asks again
    view.browser.find_element(By.CSS_SELECTOR, "#note button").click()
    view.goes_on()
    view.browser.switch_to.window(second)
    view.until("document.getElementById('note').textContent.includes('another tab now')", "the second page is told")
    view.browser.close()
    view.browser.switch_to.window(first)
    view.goes_on()
    view.severe()  # a socket that is refused is an error of the second page
    view.process.kill()
    view.until("document.getElementById('note').textContent.includes('is gone')", "the page says that the server is gone")


def check_sleep(view):
    """A page that stood still goes on at the present, says so, and never says that its server is gone."""
    view.js("window.notes = []; const n = document.getElementById('note');"
            "new MutationObserver(() => window.notes.push(n.textContent)).observe(n, { childList: true })")
    # A page that is busy reads nothing, as one whose tab sleeps.
    before = view.js("const frame = window.plumb.frame.frame, end = performance.now() + 4000;"
                     "while (performance.now() < end); return frame")
    view.until("window.notes.some(text => text.includes('slept through'))", "the page says how long it slept")
    missed = int(view.js("return window.notes.find(text => text.includes('slept through')).match(/\\d+/)[0]"))
    after = view.frame("frame")
    assert after - before > missed > 60, (before, missed, after)
    view.goes_on()
    # Chromium closes the connection of a page that it freezes.
    before = view.frame("frame")
    for state, seconds in [("frozen", 1.5), ("active", 0)]:
        view.browser.execute_cdp_cmd("Page.setWebLifecycleState", {"state": state})
        time.sleep(seconds)
    view.until("window.notes.some(text => text.includes('goes on at the present; plots and recording begin'))",
               "the page says that it is connected again")
    view.until(f"window.plumb.frame.frame > {before + 60}", "worlds ran on meanwhile")
    # Without a screen it would stay hidden.
    view.browser.execute_cdp_cmd("Emulation.setFocusEmulationEnabled", {"enabled": True})
    clock = view.js("return document.getElementById('clock').textContent")
    view.until(f"document.getElementById('clock').textContent !== '{clock}'", "it is drawn again")
    assert not view.js("return window.notes.some(text => text.includes('is gone'))"), view.js("return window.notes")
    view.severe()  # the browser logs that it closed the connection


def check_pace(view):
    """Steps that take long are told beside the clock, and so is a single one while it is computed; both go when it is fast again."""
    says = "document.getElementById('pace').textContent"
    ask = "window.plumb.page.send(window.plumb.requests.set(arguments[0], arguments[1]))"
    long = [("sweeps", 1000), ("substeps", 600)]  # so that a step takes some seconds
    assert not view.js("return " + says), "nothing is said of what is fast"
    for name, value in [("substeps", 16), ("sweeps", 300)]:
        view.js(ask, name, value)
    share, took = wait_until(lambda: re.match(r"(\S+) × real time: a step takes (\S+) ms", view.js("return " + says)),
                             "slowness is told", lambda: view.js("return " + says)).groups()
    assert float(share) < 0.9 and float(took) > 15, (share, took)
    assert view.js("return document.getElementById('pace').title"), "with a reason"
    view.js("window.paces = []; const p = document.getElementById('pace');"
            "new MutationObserver(() => window.paces.push(p.textContent)).observe(p, { childList: true })")
    for name, value in long:
        view.js(ask, name, value)
    view.until("window.paces.includes('Computing …')", "a step that takes long is told")
    view.click("reset")
    for name, value in [("sweeps", 1), ("substeps", 1)]:
        view.js(ask, name, value)
    view.until(says + " === ''", "it is fast again")
    view.goes_on()
    # Worlds that stand still compute, too, where a step is asked for.
    view.pause()
    for name, value in long:
        view.js(ask, name, value)
    wait_until(lambda: is_told_of_step(view), "a single step is told while it is computed", view.note)


def is_told_of_step(view):
    """A page that draws a picture in more than a second, since others use the computer, may miss a step: it tells the next."""
    frame = view.frame("frame")
    view.js("window.paces = []")
    view.click("step")
    view.until(f"window.plumb.frame.frame > {frame} && window.paces.at(-1) !== 'Computing …'", "a step is done")
    return view.js("return window.paces.includes('Computing …') && window.paces.at(-1) === ''")


def check_slow_frames(view):
    """A page that runs and misses frames did not sleep, and says nothing of that."""
    view.js("window.notes = []; const n = document.getElementById('note');"
            "new MutationObserver(() => window.notes.push(n.textContent)).observe(n, { childList: true });" + STANDS)
    notes = wait_until(lambda: miss_frames(view), "the page misses frames and does not stand still", view.note)[0]
    assert not any("slept" in text for text in notes), notes


def miss_frames(view):
    """Returns what the page says, if it ran all the while: where others use the computer, it may stand still indeed."""
    view.until("performance.now() > window.stood + 6000", "the page has run for a while")
    view.js("window.notes = []; window.isDeaf = true")
    stood, before = view.js("return window.stood"), view.frame("frame")
    time.sleep(2.5)
    view.js("window.isDeaf = false")
    view.until(f"window.plumb.frame.frame > {before + 61}", "frames were missed")
    view.goes_on()
    return view.js("return window.stood === arguments[0] && [window.notes]", stood)


# When the page last stood still for most of a second.
STANDS = """window.stood = 0;
let last = performance.now();
const watch = (now) => {
  if (now - last > 700) window.stood = now;
  last = now;
  requestAnimationFrame(watch);
};
requestAnimationFrame(watch);"""

# A page that is deaf says that it took frames and drops them.
DEAF = """const Plain = WebSocket;
window.WebSocket = class extends Plain {
  set onmessage(hear) {
    super.onmessage = (event) => { window.isDeaf && typeof event.data !== "string" ? this.send(new Uint8Array(0)) : hear(event); };
  }
};"""


def check_time(view):
    view.pause()
    frame = view.frame("frame")
    view.click("step")
    view.until(f"window.plumb.frame.frame === {frame + 1}", "one frame is stepped")
    view.pause(False)
    view.goes_on()


def check_replay(view, plumb, folder):
    """What the page shows is what plumb run --replay gives, and what plumb view --replay ends with."""
    view.pause()
    view.js("window.saved = null; const old = URL.createObjectURL;"
            "URL.createObjectURL = (b) => { b.text().then(t => { window.saved = t; }); return old.call(URL, b); }")
    view.click("save")
    view.until("window.saved", "a replay is saved")
    file = os.path.join(folder, "replay.json")
    with open(file, "w", encoding="utf-8") as out:
        out.write(view.js("return window.saved"))
    shown = view.frame("sides.map(s => window.plumb.hashText(s.hash))")
    run = subprocess.run([plumb, "run", "--replay", file], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert re.findall(r"^state +(0x[0-9a-f]{16})", run.stdout, re.M) == shown, (run.stdout, shown)
    # The page draws after it took the frame, so a slow machine shows the hashes a moment later.
    view.until(f"{json.dumps(shown)}.every(text => document.getElementById('legend').textContent.includes(text))",
               "the legend shows the hashes of the frame it stands at")
    with open(file, encoding="utf-8") as text:
        saved = json.load(text)
    assert saved["inputs"] and saved["frames"] > 0
    saved["hashes"][0] = "0x" + 16 * "0"
    with open(os.path.join(folder, "other.json"), "w", encoding="utf-8") as out:
        json.dump(saved, out)
    other = subprocess.run([plumb, "run", "--replay", os.path.join(folder, "other.json")],
                           capture_output=True, text=True, check=False)
    assert other.returncode == 1, "other bits are told"
    return file


def check_page(plumb, folder):
    browser = start_browser(False, 1280, 720)
    try:
        with View(plumb, browser, "--compare", "mass against equal") as view:
            assert len(view.frame("sides")) == 3
            check_end_mass(view)
            check_names(view)
            check_verdict(view)
            check_labels(view)
            check_low(view)
            check_tabs(view)
            check_over_each_other(view)
            check_words(view)
            check_hands(view)
            view.click("reset")
            view.pause(False)
            check_sliders(view)
            check_time(view)
            check_colours(view)
            check_plots(view)
            check_trails(view)
            assert view.frame("sides[2].distance") > 0, "worlds differ"
            file = check_replay(view, plumb, folder)
            check_cut_view(view)
            check_film(view, folder)
            assert not view.severe(), view.severe()
        with View(plumb, browser, "--replay", file) as view:
            view.until("!window.plumb.frame.playing", "the replay ends")
            view.until("document.getElementById('note').textContent.includes('same bits')", "bits are the same")
            assert not view.severe(), view.severe()
        with View(plumb, browser, "rope", "--compare", "relax against direct") as view:
            assert len(view.frame("sides")) == 2
            view.goes_on()
            view.pause()
            view.click("reset")
            view.until("window.plumb.frame.frame === 0", "it begins anew")
            assert not view.severe(), view.severe()
        with View(plumb, browser, "humanoid:body=medium") as view:
            check_figure(view)
            assert not view.severe(), view.severe()
        with View(plumb, browser, "chain", "--compare", "error against truth") as view:
            view.until("document.getElementById('distance').textContent.startsWith('error')", "errors are shown")
            view.until("window.plumb.frame.sides[2].distance > window.plumb.frame.sides[1].distance", "relaxed errs more")
            check_refusals(view)
        check_framing(plumb, browser)
        with View(plumb, browser, "shot:number=9") as view:
            check_scattered(view)
    finally:
        browser.quit()


def check_phone(view, picture):
    """Open controls leave a part of the page to the view, and their button stays in reach."""
    view.click("fold")
    view.js("document.getElementById('cards').scrollTop = 500")
    assert view.js("return document.getElementById('cards').scrollTop") > 100, "controls are longer than their part"
    edges = view.js("return ['view', 'panel', 'fold'].map(id => document.getElementById(id).getBoundingClientRect())"
                    ".flatMap(box => [box.top, box.bottom])")
    assert edges[1] <= edges[2] + 1 and edges[1] > 200, "the view ends where controls begin"
    assert edges[2] <= edges[4] < edges[2] + 10, "the button that closes them stands still"
    view.goes_on()
    take_picture(view.browser, picture)
    view.click("fold")
    if not view.js("return document.getElementById('why').hidden"):
        tall = "return document.getElementById('why').getBoundingClientRect().height"
        assert 30 < view.js(tall) < 44, "a line of the picture covers no worlds"
        view.browser.find_element(By.CSS_SELECTOR, "#why summary").click()
        assert view.js(tall) > 100 and view.js("return document.querySelector('#why svg').clientWidth") > 300, "it opens"
        take_picture(view.browser, picture.replace("controls", "why"))
        view.browser.find_element(By.CSS_SELECTOR, "#why summary").click()


def check_sleeper(plumb):
    browser = start_browser(False, 1280, 720)  # a tab that was frozen is no good to other tests
    try:
        with View(plumb, browser, "net:width=40,height=40", "--method", "relax") as view:
            check_pace(view)
            assert not view.severe(), view.severe()
        browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": DEAF})
        with View(plumb, browser, "heap") as view:
            check_slow_frames(view)
            check_sleep(view)
            assert not view.severe(), view.severe()
    finally:
        browser.quit()


def take_pictures(plumb, folder):
    for width, height in [(1280, 720), (390, 844)]:
        browser = start_browser(False, width, height)
        try:
            for scene, tint in [("default", "light"), ("humanoid", "light"), ("pile", "light"), ("default", "dark")]:
                set_scheme(browser, tint == "dark")
                with View(plumb, browser, *([] if scene == "default" else [scene])) as view:
                    view.until("window.plumb.frame.frame > 40", "it has moved")
                    view.until("document.getElementById('clock').textContent", "numbers are shown")
                    over = view.js("return document.documentElement.scrollWidth > innerWidth")
                    assert not over, f"{scene} is wider than {width}"
                    take_picture(browser, os.path.join(folder, f"{scene}-{tint}-{width}.png"))
                    if width < 760:
                        check_phone(view, os.path.join(folder, f"{scene}-{tint}-controls.png"))
                    assert not view.severe(), view.severe()
        finally:
            browser.quit()


def read_arguments():
    """Returns the program and a folder that is there, and works in it. Skips the test where no browser is."""
    plumb, folder = map(os.path.abspath, sys.argv[1:])
    for program in ["chromium", "chromedriver"]:
        if not shutil.which(program):
            skip(program + " is missing; tools/setup --browser installs it")
    os.makedirs(folder, exist_ok=True)
    os.chdir(folder)
    # What draws without a graphics card waits for work in loops, with a thread of its own for each processor.
    with open("SwiftShader.ini", "w", encoding="ascii") as settings:
        settings.write("[Processor]\nThreadCount=1\n")
    return plumb, folder


def main():
    plumb, folder = read_arguments()
    check_page(plumb, folder)
    check_sleeper(plumb)
    take_pictures(plumb, folder)


if __name__ == "__main__":
    main()
