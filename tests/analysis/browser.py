"""A page in headless Chromium, through its DevTools protocol over a pipe (chromedevtools.github.io/devtools-protocol)."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import threading
from queue import Empty, Queue

PROGRAM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--hide-scrollbars",
         "--disable-dev-shm-usage", "--remote-debugging-pipe")
PATIENCE_S = 60


class Browser:
    """One browser with one page. Use as `with Browser() as page:`."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self.to = os.pipe()
        self.of, from_browser = os.pipe()

        def on_3_and_4():
            low = [os.dup(fd) if fd < 5 else fd for fd in (to_browser, from_browser)]    # out of the way of each other
            for fd, place in zip(low, (3, 4)):
                os.dup2(fd, place)

        self.process = subprocess.Popen([PROGRAM, *FLAGS, f"--user-data-dir={self.folder.name}", "about:blank"],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        preexec_fn=on_3_and_4, close_fds=False)
        os.close(to_browser)
        os.close(from_browser)
        self.answers, self.events, self.sent, self.session = Queue(), [], 0, None
        threading.Thread(target=self._listen, daemon=True).start()
        target = next(one for one in self.send("Target.getTargets")["targetInfos"] if one["type"] == "page")
        self.session = self.send("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.session = None
        self.send("Browser.close")
        self.process.wait(PATIENCE_S)
        os.close(self.to)
        self.folder.cleanup()

    def _listen(self):
        with os.fdopen(self.of, "rb") as pipe:
            waiting = b""
            while some := pipe.read1(1 << 20):
                *messages, waiting = (waiting + some).split(b"\0")
                for message in map(json.loads, messages):
                    (self.answers.put if "id" in message else self.events.append)(message)

    def send(self, method, **parameters):
        """The result of a command; waits for it."""
        self.sent += 1
        message = {"id": self.sent, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            try:
                answer = self.answers.get(timeout=PATIENCE_S)
            except Empty:
                raise TimeoutError(f"{PROGRAM} has not answered {method} in {PATIENCE_S} s") from None
            if answer["id"] == self.sent:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def open(self, path, width=1280, height=900, dark=False, still=True, phone=False):
        """Shows a file and waits until its scripts have run and its frames are drawn."""
        self.events.clear()
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        features = {"prefers-color-scheme": "dark" if dark else "light",
                    "prefers-reduced-motion": "reduce" if still else "no-preference"}
        self.send("Emulation.setEmulatedMedia", features=[{"name": n, "value": v} for n, v in features.items()])
        self.send("Page.navigate", url=f"file://{os.path.abspath(path)}")
        self.run("new Promise(done => { if (document.readyState === 'complete') done();"
                 "else addEventListener('load', done); })")
        self.settle()

    def settle(self):
        """Until what was changed is drawn."""
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(null))))")

    def run(self, code):
        """The value of a JavaScript expression in the page, of a promise what it becomes."""
        found = self.send("Runtime.evaluate", expression=code, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"].get("exception", found["exceptionDetails"]).get("description"))
        return found["result"].get("value")

    def complaints(self):
        """Errors and warnings of the page's console, and what was thrown."""
        found = []
        for event in self.events:
            what, told = event["method"], event["params"]
            if what == "Runtime.exceptionThrown":
                details = told["exceptionDetails"]
                found.append(details.get("exception", {}).get("description", details["text"]))
            elif what == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
                found.append(" ".join(str(one.get("value", one.get("description"))) for one in told["args"]))
            elif what == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
                found.append(told["entry"]["text"])
        return found

    def requests(self):
        """Addresses that the page asked for, but for those of data within it."""
        urls = [event["params"]["request"]["url"] for event in self.events
                if event["method"] == "Network.requestWillBeSent"]
        return [url for url in urls if not url.startswith("data:")]

    def box(self, selector):
        """(left, top, width, height) of an element, scrolled into view."""
        return self.run(f"(() => {{ const found = document.querySelector({json.dumps(selector)});"
                        "found.scrollIntoView({block: 'center', behavior: 'instant'});"
                        "const b = found.getBoundingClientRect();"
                        "return [b.left, b.top, b.width, b.height]; })()")

    def move(self, x, y):
        self.send("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self.settle()

    def click(self, selector):
        left, top, width, height = self.box(selector)
        for kind in ("mousePressed", "mouseReleased"):
            self.send("Input.dispatchMouseEvent", type=kind, x=left + width / 2, y=top + height / 2, button="left",
                      clickCount=1)
        self.settle()

    def key(self, name, code=0, text=""):
        for kind in ("keyDown", "keyUp"):
            self.send("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code,
                      **({"text": text} if text and kind == "keyDown" else {}))
        self.settle()

    def picture(self, path, whole=True):
        shot = self.send("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        with open(path, "wb") as out:
            out.write(base64.b64decode(shot["data"]))

    def paper(self, path):
        printed = self.send("Page.printToPDF", printBackground=True, preferCSSPageSize=True)
        with open(path, "wb") as out:
            out.write(base64.b64decode(printed["data"]))
