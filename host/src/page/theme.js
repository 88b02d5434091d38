// Light and dark: as the system has it until a person says otherwise.

const KEY = "vrduino.theme";

/** Linear colours and brightnesses for the two scenes. */
export const LIGHTS = {
  dark: {
    bench: {
      sunlight: [1.35, 1.25, 1.1], skylight: [0.5, 0.58, 0.75], groundlight: [0.12, 0.13, 0.18],
      haze: [0, 0, 0], hazy: 0, line: [0.2, 0.25, 0.37], ground: [0, 0, 0], shade: [0, 0, 0, 0.4],
    },
    court: {
      sunlight: [0.5, 0.55, 0.72], skylight: [0.46, 0.4, 0.42], groundlight: [0.34, 0.25, 0.2],
      haze: [0.012, 0.02, 0.055], hazy: 0.00004, line: [0.34, 0.36, 0.46], ground: [0.17, 0.17, 0.23],
      zenith: [0.03, 0.05, 0.13], horizon: [0.14, 0.17, 0.31], starry: 1,
    },
  },
  light: {
    bench: {
      sunlight: [1.15, 1.1, 1.0], skylight: [0.8, 0.85, 0.95], groundlight: [0.4, 0.38, 0.36],
      haze: [1, 1, 1], hazy: 0, line: [0.74, 0.79, 0.87], ground: [0, 0, 0], shade: [0.1, 0.13, 0.2, 0.22],
    },
    court: {
      sunlight: [0.85, 0.78, 0.62], skylight: [0.42, 0.5, 0.62], groundlight: [0.24, 0.21, 0.18],
      haze: [0.6, 0.74, 0.86], hazy: 0.000022, line: [0.72, 0.68, 0.6], ground: [0.86, 0.82, 0.75],
      zenith: [0.24, 0.5, 0.84], horizon: [0.78, 0.88, 0.95], starry: 0,
    },
  },
};
// Shades are multiplied with their alpha once, as blending wants them.
for (const { bench } of Object.values(LIGHTS)) {
  bench.shade = bench.shade.map((value, i, all) => (i < 3 ? value * all[3] : value));
}

export class Theme {
  /** `changed(dark)` is called at the start and with every change. */
  constructor(changed) {
    this.changed = changed;
    this.system = matchMedia("(prefers-color-scheme: dark)");
    this.chosen = remembered();
    this.system.addEventListener("change", () => this.apply());
    this.apply();
  }

  get dark() {
    return this.chosen ? this.chosen === "dark" : this.system.matches;
  }

  toggle() {
    this.chosen = this.dark ? "light" : "dark";
    try {
      localStorage.setItem(KEY, this.chosen);
    } catch {
      // A browser that keeps nothing forgets it with the page.
    }
    this.apply();
  }

  apply() {
    document.documentElement.dataset.theme = this.dark ? "dark" : "light";
    this.changed(this.dark);
  }
}

function remembered() {
  try {
    const kept = localStorage.getItem(KEY);
    return kept === "dark" || kept === "light" ? kept : null;
  } catch {
    return null;
  }
}
