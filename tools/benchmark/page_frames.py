#!/usr/bin/env python3
"""What a frame of the page costs: milliseconds of its script a frame, and frames a second, while 200 beams on hinges play.

Usage: tools/benchmark/page_frames.py [--mbd build/release/mbd] [--beams 200] [--size 1280x800] [--keep DIR]
Runs a model of that many hinged, swinging beams (two elements each), opens its page in a headless Chromium and lets it play, in a
loop, twice: as it is, where Chromium's SwiftShader paints every point on the processor, for want of a graphics processor; and with
WebGL's drawing calls left out, which is all that the page itself has to do: interpolation, surfaces, colours, uploads. "script" is the
time inside the page's own function of a frame; a screen of 60 frames a second leaves 16.7 ms for it.
"""
import argparse
import html
import json
import pathlib
import re
import subprocess
import tempfile

root = pathlib.Path(__file__).resolve().parents[2]

MODEL = """<mbd name="many">
  <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>
  <repeat count="{beams}" index="i">
    <beam name="b{{i}}" section="s" from="0 0.3*i 0" to="1 0.3*i 0" normal="0 0 1" elements="2"/>
    <revolute name="j{{i}}" between="ground b{{i}}.start" axis="0 1 0"/>
  </repeat>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="2" step="0.01" rho_infinity="0"/>
</mbd>
"""

# Before the page's own scripts: what it hands to requestAnimationFrame is timed.
WATCH = """<script>
  if (!PAINT)
    for (const context of [window.WebGLRenderingContext, window.WebGL2RenderingContext]) {
      for (const name of ['drawElements', 'drawArrays', 'drawElementsInstanced', 'drawArraysInstanced'])
        if (context.prototype[name]) context.prototype[name] = () => {};
      const extension = context.prototype.getExtension;
      context.prototype.getExtension = function (name) {
        const found = extension.call(this, name);
        if (found && name === 'ANGLE_instanced_arrays') found.drawElementsInstancedANGLE = found.drawArraysInstancedANGLE = () => {};
        return found;
      };
    }
  const spent = [], stamps = [], plain = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = f => plain(now => {
    const begin = performance.now();
    f(now);
    spent.push(performance.now() - begin);
    stamps.push(now);
  });
</script>"""

# An open document holds back the end of loading, and so the browser's, until the answer is there.
ASK = """<pre id="answer"></pre><iframe id="open" style="display:none"></iframe><script>(async () => {
  const end = document.getElementById('open').contentDocument;
  end.open();
  const wait = ms => new Promise(done => setTimeout(done, ms)), by = id => document.getElementById(id);
  await wait(500);
  if (!by('loop').checked) by('loop').click();
  by('play').click();
  await wait(1000);
  spent.length = stamps.length = 0;
  await wait(8000);
  by('play').click();
  by('answer').textContent = JSON.stringify({spent, seconds: (stamps[stamps.length - 1] - stamps[0]) / 1000});
  end.close();
})();</script>"""


def answer_of(work, size):
    dom = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader",
                          f"--user-data-dir={work / 'profile'}", f"--window-size={size.replace('x', ',')}", "--dump-dom",
                          f"file://{(work / 'timed.html').resolve()}"], capture_output=True, text=True, timeout=300).stdout
    return json.loads(html.unescape(re.search(r'<pre id="answer">(.*?)</pre>', dom, re.S).group(1)))


def report(beams, paints, answer):
    spent = sorted(answer["spent"])
    print(f"{beams} beams, {'painted by the processor' if paints else 'nothing painted'}: {len(spent)} frames in "
          f"{answer['seconds']:.1f} s, {len(spent) / answer['seconds']:.0f} a second; script: median {spent[len(spent) // 2]:.2f} ms "
          f"a frame, 99 of 100 below {spent[int(0.99 * len(spent))]:.2f} ms, largest {spent[-1]:.2f} ms")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mbd", default=root / "build" / "release" / "mbd")
    parser.add_argument("--beams", type=int, default=200)
    parser.add_argument("--size", default="1280x800")
    parser.add_argument("--keep", type=pathlib.Path)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        work = args.keep or pathlib.Path(name)
        work.mkdir(parents=True, exist_ok=True)
        (work / "many.xml").write_text(MODEL.format(beams=args.beams))
        subprocess.run([args.mbd, "run", work / "many.xml", "--view", "--quiet", "--out", work / "results"], check=True)
        page = (work / "results" / "view.html").read_text()
        at, end = page.index("<style>"), page.rindex("</body>")
        for paints in (False, True):
            (work / "timed.html").write_text(page[:at] + WATCH.replace("PAINT", str(paints).lower()) + page[at:end] + ASK + page[end:])
            report(args.beams, paints, answer_of(work, args.size))


if __name__ == "__main__":
    main()
