"use strict";
// Draws a match from the data on the page. Positions are metres with y upwards; the canvas counts downwards.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const { account } = data;
  const sketches = account.sketches;
  const end = sketches.length ? sketches[sketches.length - 1].time : 0;
  const COLOURS = {
    init: "#6b7280", undefined: "#111827", game_over: "#4b5563", turn_to_ball: "#b45309", goto_ball: "#1d6fb8",
    turn_to_goal: "#7c3aed", dribble_to_goal: "#15803d", kick_ball_to_goal: "#be185d",
  };
  const byId = (id) => document.getElementById(id);
  const seconds = (nanos) => nanos / 1e9;
  const states = account.states.map(([at, name]) => ({ at: seconds(at), name }));
  const violations = account.happenings.filter((h) => h.name.startsWith("!")).map((h) => ({ at: seconds(h.time), name: h.name.slice(1) }));
  const colour = (name) => COLOURS[name] || "#374151";
  let now = 0;
  let playing = false;

  // The last of a list, in the order of time, that had begun by then.
  const latest = (list, time, key) => {
    let low = 0, high = list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (list[middle][key] <= time) low = middle + 1; else high = middle;
    }
    return low - 1;
  };

  const field = byId("field").getContext("2d");
  const [[left, low], [right, high]] = data.corners;
  const scale = byId("field").width / (right - left);
  byId("field").height = Math.round((high - low) * scale);
  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  const inFrame = (x, y, yaw, draw) => {
    field.save();
    field.translate(x, y);
    field.rotate(yaw);
    draw();
    field.restore();
  };
  const disc = (x, y, radius, fill) => {
    field.beginPath();
    field.arc(x, y, radius, 0, 2 * Math.PI);
    field.fillStyle = fill;
    field.fill();
  };

  const between = (time) => {
    const at = Math.max(0, latest(sketches, time, "time"));
    const [one, other] = [sketches[at], sketches[Math.min(at + 1, sketches.length - 1)]];
    const share = other.time > one.time ? (time - one.time) / (other.time - one.time) : 0;
    const mix = (a, b) => a + (b - a) * Math.min(1, Math.max(0, share));
    const jumps = Math.hypot(other.ball[0] - one.ball[0], other.ball[1] - one.ball[1]) > 0.2;
    const turned = Math.atan2(Math.sin(other.robot[2] - one.robot[2]), Math.cos(other.robot[2] - one.robot[2]));
    return {
      robot: [mix(one.robot[0], other.robot[0]), mix(one.robot[1], other.robot[1]), one.robot[2] + turned * share],
      ball: jumps ? one.ball : [mix(one.ball[0], other.ball[0]), mix(one.ball[1], other.ball[1])],
      shines: one.shines,
    };
  };

  const drawGoal = () => {
    const [x, y, yaw] = data.goal;
    const [width, depth] = data.goal_size;
    inFrame(x, y, yaw, () => {
      field.beginPath();
      field.moveTo(0, -width / 2);
      field.lineTo(depth, -width / 2);
      field.lineTo(depth, width / 2);
      field.lineTo(0, width / 2);
      field.strokeStyle = ink("--ink");
      field.lineWidth = 0.03;
      field.stroke();
    });
    field.beginPath();
    field.arc(x, y, data.goal_range, 0, 2 * Math.PI);
    field.setLineDash([0.04, 0.04]);
    field.lineWidth = 0.008;
    field.strokeStyle = ink("--faint");
    field.stroke();
    field.setLineDash([]);
  };

  const drawTrail = () => {
    const upto = latest(sketches, now, "time");
    const trail = (pick, style) => {
      field.beginPath();
      sketches.slice(0, upto + 1).forEach((s, i) => (i ? field.lineTo(...pick(s)) : field.moveTo(...pick(s))));
      field.strokeStyle = style;
      field.lineWidth = 0.008;
      field.stroke();
    };
    trail((s) => [s.robot[0], s.robot[1]], ink("--faint"));
    trail((s) => s.ball, "#d97706");
  };

  const drawRobot = (robot, fill) => {
    const [length, width] = data.body;
    inFrame(robot[0], robot[1], robot[2], () => {
      field.fillStyle = field.strokeStyle = fill;
      field.fillRect(-length / 2, -width / 2, length, width);
      field.lineWidth = data.arm_thick;
      for (const side of [-1, 1]) {
        field.beginPath();
        data.arm.forEach(([ahead, left], i) => (i ? field.lineTo(ahead, side * left) : field.moveTo(ahead, side * left)));
        field.stroke();
      }
      disc(length / 2 - 0.02, 0, 0.015, "#fff");
    });
  };

  const drawField = (state) => {
    field.setTransform(1, 0, 0, 1, 0, 0);
    field.fillStyle = ink("--grass");
    field.fillRect(0, 0, field.canvas.width, field.canvas.height);
    field.setTransform(scale, 0, 0, -scale, -left * scale, high * scale);
    drawGoal();
    drawTrail();
    const { robot, ball, shines } = between(now);
    if (shines) disc(ball[0], ball[1], data.ball * 1.8, "rgba(217, 119, 6, 0.25)");
    disc(ball[0], ball[1], data.ball, shines ? "#d97706" : "#6b7280");
    drawRobot(robot, colour(state));
  };

  const bar = byId("bar").getContext("2d");
  const across = (time) => (end ? (time / end) * bar.canvas.width : 0);
  const drawBar = () => {
    bar.clearRect(0, 0, bar.canvas.width, bar.canvas.height);
    states.forEach(({ at, name }, i) => {
      const until = i + 1 < states.length ? states[i + 1].at : end;
      bar.fillStyle = colour(name);
      bar.fillRect(across(at), 26, Math.max(1, across(until) - across(at)), 40);
    });
    bar.fillStyle = ink("--bad");
    violations.forEach(({ at }) => {
      // One at the very end is not to be cut.
      const x = Math.min(bar.canvas.width - 9, Math.max(9, across(at)));
      bar.beginPath();
      bar.moveTo(x, 24);
      bar.lineTo(x - 9, 4);
      bar.lineTo(x + 9, 4);
      bar.fill();
    });
    bar.fillStyle = ink("--ink");
    bar.fillRect(across(now) - 1.5, 20, 3, 52);
  };

  const show = (time) => {
    now = Math.min(end, Math.max(0, time));
    const state = states[Math.max(0, latest(states, now, "at"))];
    const name = state ? state.name : "";
    byId("state").textContent = name;
    byId("state").style.background = colour(name);
    byId("clock").textContent = `${now.toFixed(2)} s`;
    byId("seek").value = now;
    const items = byId("violations").children;
    violations.forEach(({ at }, i) => items[i].classList.toggle("past", at <= now));
    if (sketches.length) drawField(name);
    drawBar();
  };

  const press = (on) => {
    playing = on;
    byId("play").textContent = on ? "Pause" : "Play";
    byId("play").setAttribute("aria-pressed", String(on));
    if (!on) return;
    if (now >= end) show(0);
    let before = performance.now();
    const step = (at) => {
      if (!playing) return;
      show(now + ((at - before) / 1000) * Number(byId("speed").value));
      before = at;
      if (now >= end) press(false); else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  };

  const element = (name, text, parent) => {
    const made = document.createElement(name);
    made.textContent = text;
    parent.append(made);
    return made;
  };

  byId("about").textContent = `${account.fault ? `Fault: ${account.fault}` : "No fault"}. Seed ${account.seed}. The ball is ${account.goal ? "" : "not "}in the goal.`;
  [...new Set(states.map((s) => s.name))].forEach((name) => {
    const item = element("li", "", byId("legend"));
    element("i", "", item).style.background = colour(name);
    item.append(name);
  });
  violations.forEach(({ at, name }) => {
    const jump = element("button", `${at.toFixed(2)} s  ${name}`, element("li", "", byId("violations")));
    jump.type = "button";
    jump.addEventListener("click", () => { press(false); show(at); });
  });
  if (!violations.length) element("li", "none", byId("violations"));
  account.judged.forEach(({ name, verdict }) => {
    const row = element("tr", "", document.querySelector("#properties tbody"));
    element("td", name, row);
    element("td", verdict, row).className = verdict;
  });
  byId("seek").max = end;
  byId("seek").addEventListener("input", (event) => { press(false); show(Number(event.target.value)); });
  byId("play").addEventListener("click", () => press(!playing));
  document.addEventListener("keydown", (event) => {
    if (event.target.closest("button, select")) return;
    if (event.key === " ") { event.preventDefault(); press(!playing); }
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => show(now));
  show(0);
})();
