// Short sounds of the game's events, made by the browser.

const NOTES = {
  arrival: [[660, 0.09]],
  question: [[520, 0.09], [700, 0.12]],
  find: [[780, 0.08], [980, 0.08], [1180, 0.14]],
  lost: [[330, 0.16], [240, 0.24]],
  won: [[660, 0.1], [880, 0.1], [1320, 0.2]],
};
let context = null;

export function play(name) {
  const notes = NOTES[name];
  if (!notes || localStorage.getItem("sound") === "off") return;
  try {
    context ??= new AudioContext();
  } catch {
    return;
  }
  let at = context.currentTime;
  for (const [frequency, duration] of notes) {
    const tone = context.createOscillator();
    const volume = context.createGain();
    tone.frequency.value = frequency;
    volume.gain.setValueAtTime(0.0001, at);
    volume.gain.exponentialRampToValueAtTime(0.12, at + 0.015);
    volume.gain.exponentialRampToValueAtTime(0.0001, at + duration);
    tone.connect(volume).connect(context.destination);
    tone.start(at);
    tone.stop(at + duration);
    at += duration * 0.8;
  }
}
