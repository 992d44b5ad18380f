// Applies differences between trees; see ui/web/page/patches.py. Unchanged parts stay the same objects.

export function applied(before, patch) {
  if ("v" in patch) return patch.v;
  if ("f" in patch) {
    const after = { ...before };
    for (const [name, change] of Object.entries(patch.f)) after[name] = applied(before[name], change);
    return after;
  }
  const [length, changes, added] = patch.l;
  const after = before.slice(0, length);
  for (const [index, change] of Object.entries(changes)) after[index] = applied(before[index], change);
  return after.concat(added);
}
