// Plays every motion of this document that does not play yet: docs/design.md, "A motion in a notebook".
(() => {
  const CAPSULES = "CAPSULES";
  const [PITCH, SIDE, AWAY] = [0.2, "VIEW", 7];
  const LIGHT = { body: [106, 99, 90], left: [221, 90, 34], right: [156, 147, 135], floor: "#efebe3", line: "#c9c1b2", ink: "#1d1a16" };
  const DARK = { body: [207, 199, 186], left: [255, 130, 70], right: [150, 141, 129], floor: "#211f1c", line: "#4a443c", ink: "#f3eee5" };
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;

  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

  /** Positions (frame, joint, axis) in metres, and where the camera aims, from the bytes that player.py packs. */
  const unpack = (data) => {
    const head = new DataView(data);
    const [frames, joints] = [head.getUint32(0, true), head.getUint32(4, true)];
    const [fps, far, near, yaw, zoom, eye] = [8, 12, 16, 20, 24, 28].map((at) => head.getFloat32(at, true));
    const root = new Int16Array(data, 32, 3 * frames);
    const aims = new Int16Array(data, 32 + 6 * frames, 2 * frames);
    const others = new Int8Array(data, 32 + 10 * frames);
    const at = new Float32Array(3 * joints * frames);
    for (let t = 0; t < frames; t++)
      for (let j = 0; j < joints; j++)
        for (let i = 0; i < 3; i++) at[3 * (t * joints + j) + i] = far * root[3 * t + i] + (j ? near * others[3 * (t * (joints - 1) + j - 1) + i] : 0);
    return { frames, joints, fps, yaw, zoom, eye, at, aim: Float32Array.from(aims, (value) => far * value) };
  };

  const start = (figure) => {
    const motion = unpack(bytes(figure.dataset.motionseek));
    figure.removeAttribute("data-motionseek");
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d");
    const poster = figure.querySelector("svg");
    const label = poster.getAttribute("aria-label");
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "button");
    canvas.style.cssText = "display:block;width:100%;aspect-ratio:1;border-radius:10px;cursor:grab;touch-action:pan-y";
    poster.replaceWith(canvas);
    const last = (motion.frames - 1) / motion.fps;
    let [time, yaw, playing, visible, before] = [still ? last / 2 : 0, motion.yaw + SIDE, !still && last > 0, true, 0];

    const pose = new Float32Array(3 * motion.joints);
    const draw = () => {
      const size = canvas.clientWidth * (devicePixelRatio || 1);
      if (!size) return;
      if (canvas.width !== Math.round(size)) canvas.width = canvas.height = Math.round(size);
      const text = getComputedStyle(figure).color.match(/[\d.]+/g).map(Number);
      const look = text[0] + text[1] + text[2] > 384 ? DARK : LIGHT;
      const frame = Math.min(time * motion.fps, motion.frames - 1);
      const [from, part] = [Math.floor(frame), frame % 1];
      const to = Math.min(from + 1, motion.frames - 1);
      const between = (list, width, i) => list[from * width + i] + part * (list[to * width + i] - list[from * width + i]);
      for (let i = 0; i < pose.length; i++) pose[i] = between(motion.at, pose.length, i);
      const [x0, z0] = [between(motion.aim, 2, 0), between(motion.aim, 2, 1)];
      const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(PITCH), Math.cos(PITCH)];
      const metre = size / (2.15 * motion.zoom);
      const seen = (x, y, z) => {
        [x, y, z] = [x - x0, y - motion.eye, z - z0];
        const towards = sy * x + cy * z;
        const depth = cp * towards + sp * y;
        const scale = (metre * AWAY) / Math.max(AWAY - depth, 0.5);
        return [size / 2 + scale * (cy * x - sy * z), size / 2 - scale * (cp * y - sp * towards), depth, scale];
      };
      const limbs = CAPSULES.map(([a, b, near, far, tint, beyond]) => {
        const begin = [0, 1, 2].map((i) => pose[3 * a + i]);
        let end = [0, 1, 2].map((i) => pose[3 * b + i]);
        if (beyond) {
          const back = begin.map((value, i) => value - end[i]);
          end = begin.map((value, i) => value + (beyond * back[i]) / (Math.hypot(...back) || 1));
        }
        const [p, q] = [seen(...begin), seen(...end)];
        return { begin, end, p, q, near: near * p[3], far: far * q[3], tint, depth: (p[2] + q[2]) / 2 };
      });
      pen.fillStyle = look.floor;
      pen.fillRect(0, 0, size, size);
      ground(pen, look, seen, x0, z0, size);
      shadow(pen, seen, limbs, metre);
      for (const limb of limbs.sort((one, other) => one.depth - other.depth)) capsule(pen, limb, look[limb.tint]);
      pen.fillStyle = look.ink;
      if (last > 0) pen.fillRect(0, size * 0.99, (size * time) / last, size * 0.01);
      if (!playing && last > 0) {
        pen.beginPath();
        for (const [x, y] of [[0.05, 0.86], [0.05, 0.95], [0.125, 0.905]]) pen.lineTo(size * x, size * y);
        pen.fill();
      }
    };

    const tick = (now) => {
      if (!canvas.isConnected) return;
      if (before) time = (time + Math.min(now - before, 100) / 1000) % (last + 0.3);
      before = now;
      draw();
      if (playing && visible) requestAnimationFrame(tick);
      else before = 0;
    };
    const turn = () => {
      canvas.setAttribute("aria-pressed", String(playing));
      canvas.setAttribute("aria-label", `${playing ? "Pause" : "Play"}: ${label}`);
      if (playing && visible && !before) requestAnimationFrame(tick);
      else draw();
    };
    const toggle = () => {
      playing = !playing && last > 0;
      turn();
    };
    let held = null;
    canvas.onpointerdown = (event) => {
      held = { x: event.clientX, yaw, moved: false };
      canvas.setPointerCapture(event.pointerId);
    };
    canvas.onpointermove = (event) => {
      if (!held) return;
      held.moved ||= Math.abs(event.clientX - held.x) > 4;
      yaw = held.yaw - (event.clientX - held.x) * 0.01;
      if (!playing) draw();
    };
    canvas.onpointerup = () => {
      if (held && !held.moved) toggle();
      held = null;
    };
    canvas.onpointercancel = () => (held = null);
    canvas.onkeydown = (event) => {
      const way = { ArrowLeft: -0.2, ArrowRight: 0.2 }[event.key];
      if (event.key === " " || event.key === "Enter") toggle();
      else if (way) yaw += way;
      else return;
      event.preventDefault();
      event.stopPropagation();
      if (!playing) draw();
    };
    new IntersectionObserver(([entry]) => {
      visible = entry.isIntersecting;
      turn();
    }).observe(canvas);
    new ResizeObserver(draw).observe(canvas);
  };

  /** Lines half a metre apart around the figure. */
  const ground = (pen, look, seen, x0, z0, size) => {
    pen.strokeStyle = look.line;
    pen.lineWidth = size / 400;
    for (let i = -3; i <= 3; i++) {
      const [x, z] = [(Math.round(2 * x0) + i) / 2, (Math.round(2 * z0) + i) / 2];
      for (const [from, to] of [[[x, z0 - 1.5], [x, z0 + 1.5]], [[x0 - 1.5, z], [x0 + 1.5, z]]]) {
        pen.globalAlpha = 0.75 * Math.max(0, 1 - Math.abs(i) / 3.4);
        pen.beginPath();
        pen.moveTo(...seen(from[0], 0, from[1]));
        pen.lineTo(...seen(to[0], 0, to[1]));
        pen.stroke();
      }
    }
    pen.globalAlpha = 1;
  };

  const shadow = (pen, seen, limbs, metre) => {
    pen.lineCap = pen.lineJoin = "round";
    pen.strokeStyle = "rgba(0,0,0,0.03)";
    for (let wide = 0.04; wide < 0.3; wide += 0.035) {
      pen.lineWidth = wide * metre;
      pen.beginPath();
      for (const { begin, end } of limbs) {
        pen.moveTo(...seen(begin[0], 0, begin[2]));
        pen.lineTo(...seen(end[0], 0, end[2]));
      }
      pen.stroke();
    }
  };

  /** A limb with round ends, lit from above the viewer's left shoulder. */
  const capsule = (pen, { p, q, near, far }, tint) => {
    const [dx, dy] = [q[0] - p[0], q[1] - p[1]];
    const length = Math.hypot(dx, dy);
    const shade = (gain) => `rgb(${tint.map((value) => Math.min(255, Math.round(value * gain)))})`;
    const [x, y, wide] = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, Math.max(near, far)];
    const across = length > 1 ? [dy / length, -dx / length] : [0, -1];
    const facing = across[0] * -0.5 + across[1] * -0.87;
    const [ux, uy] = facing < 0 ? [-across[0], -across[1]] : across;
    const fill = pen.createLinearGradient(x + wide * ux, y + wide * uy, x - wide * ux, y - wide * uy);
    const lit = Math.abs(facing);
    fill.addColorStop(0, shade(0.98 + 0.2 * lit));
    fill.addColorStop(1, shade(0.82 - 0.26 * lit));
    pen.fillStyle = fill;
    const along = Math.atan2(dy, dx);
    const lean = length > Math.abs(near - far) ? Math.acos((near - far) / length) : near > far ? 0 : Math.PI;
    pen.beginPath();
    pen.arc(p[0], p[1], near, along + lean, along - lean);
    pen.arc(q[0], q[1], far, along - lean, along + lean);
    pen.fill();
  };

  document.querySelectorAll("[data-motionseek]").forEach(start);
})();
