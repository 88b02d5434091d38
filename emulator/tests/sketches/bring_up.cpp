// Measures on a board what the manuals leave open; docs/bring-up.md says what to expect.
// Every line: a name, a figure, a unit.
#include <Arduino.h>
#include <Wire.h>

static const uint8_t SENSOR = 0x68;

// Runs before memory is initialised: figures wait in the system register file.
static volatile uint32_t *const KEPT = (volatile uint32_t *)0x40041000;

extern "C" void startup_early_hook(void) {
  WDOG_STCTRLH = WDOG_STCTRLH_ALLOWUPDATE;
  ARM_DEMCR |= ARM_DEMCR_TRCENA;
  ARM_DWT_CTRL |= ARM_DWT_CTRL_CYCCNTENA;
  uint32_t start = ARM_DWT_CYCCNT;
  OSC0_CR = OSC_SC8P | OSC_SC2P;
  MCG_C2 = MCG_C2_RANGE0(2) | MCG_C2_EREFS;
  MCG_C1 = MCG_C1_CLKS(2) | MCG_C1_FRDIV(4);
  while (!(MCG_S & MCG_S_OSCINIT0)) {
  }
  KEPT[0] = ARM_DWT_CYCCNT - start;
  while (MCG_S & MCG_S_IREFST) {
  }
  while ((MCG_S & MCG_S_CLKST_MASK) != MCG_S_CLKST(2)) {
  }
  MCG_C5 = MCG_C5_PRDIV0(5);
  start = ARM_DWT_CYCCNT;
  MCG_C6 = MCG_C6_PLLS | MCG_C6_VDIV0(3);
  while (!(MCG_S & MCG_S_LOCK0)) {
  }
  KEPT[1] = ARM_DWT_CYCCNT - start;
  // Back to where the core expects to begin.
  MCG_C6 = 0;
  while (MCG_S & MCG_S_PLLST) {
  }
  MCG_C1 = MCG_C1_IREFS;
  while ((MCG_S & MCG_S_CLKST_MASK) != MCG_S_CLKST(0)) {
  }
}

static void say(const char *name, float figure, const char *unit) {
  Serial.print(name);
  Serial.print(' ');
  Serial.print(figure, 2);
  Serial.print(' ');
  Serial.println(unit);
}

// The same thousand rounds of four instructions, from flash and from RAM.
#define ROUNDS asm volatile("movw r0, #1000\n1: nop\nnop\nsubs r0, #1\nbne 1b" ::: "r0", "cc")
__attribute__((noinline)) static void roundsInFlash() { ROUNDS; }
FASTRUN __attribute__((noinline)) static void roundsInRam() { ROUNDS; }

__attribute__((noinline)) static float softFloat() {
  volatile float x = 1.0f;
  for (int i = 0; i < 1000; i++) x = x * 1.0001f + 0.001f;
  return x;
}

template <typename F> static float cycles(F work) {
  __disable_irq();
  uint32_t start = ARM_DWT_CYCCNT;
  work();
  uint32_t took = ARM_DWT_CYCCNT - start;
  __enable_irq();
  return took;
}

static void processor() {
  uint32_t start = ARM_DWT_CYCCNT;
  uint32_t since = micros();
  while (micros() - since < 10000) {
  }
  say("core-clock", (ARM_DWT_CYCCNT - start) / 10000.0f, "MHz");
  say("round-in-ram", cycles(roundsInRam) / 1000, "cycles");
  say("round-in-flash", cycles(roundsInFlash) / 1000, "cycles");
  say("soft-float", cycles(softFloat) / 1000, "cycles");
}

static uint8_t readRegister(uint8_t number) {
  Wire.beginTransmission(SENSOR);
  Wire.write(number);
  Wire.endTransmission(false);
  Wire.requestFrom(SENSOR, (uint8_t)1);
  return Wire.read();
}

static bool writeRegister(uint8_t number, uint8_t value) {
  Wire.beginTransmission(SENSOR);
  Wire.write(number);
  Wire.write(value);
  return Wire.endTransmission() == 0;
}

static void bus() {
  uint32_t start = ARM_DWT_CYCCNT;
  Wire.beginTransmission(SENSOR);
  uint8_t missing = Wire.endTransmission();
  say("bus-probe", (ARM_DWT_CYCCNT - start) / (F_CPU / 1e6f), "us");
  say("bus-answer", missing, "(0: it is there)");
  start = ARM_DWT_CYCCNT;
  while (I2C0_S & I2C_S_BUSY) {
  }
  say("busy-after-stop", (ARM_DWT_CYCCNT - start) / (F_CPU / 1e6f), "us");
}

static void sensor() {
  say("who-am-i", readRegister(0x75), "(113: MPU-9250)");
  writeRegister(0x6B, 0x80);
  uint32_t start = micros();
  do {
    Wire.beginTransmission(SENSOR);
  } while (Wire.endTransmission() != 0 && micros() - start < 1000000);
  say("start-after-reset", (micros() - start) / 1000.0f, "ms");
  writeRegister(0x6B, 0x01);
  writeRegister(0x1A, 0x01);  // low-pass filter on: 1 kHz
  writeRegister(0x1B, 0x18);  // +-2000 deg/s
  delay(100);
  readRegister(0x3A);
  delay(5);
  say("ready-without-interrupt", readRegister(0x3A) & 1, "(1: INT_STATUS shows data all the same)");
  uint32_t samples = 0;
  for (start = micros(); micros() - start < 1000000;) samples += readRegister(0x3A) & 1;
  say("sample-rate", samples, "Hz");
  int16_t warmth = readRegister(0x41) << 8 | readRegister(0x42);
  say("temperature", warmth / 333.87f + 21, "deg C");
  float sum = 0, squares = 0;
  for (int i = 0; i < 500; i++) {
    int16_t rate = readRegister(0x43) << 8 | readRegister(0x44);
    sum += rate / 16.4f;
    squares += rate / 16.4f * rate / 16.4f;
    delay(1);
  }
  float mean = sum / 500;
  say("gyro-bias", mean, "deg/s");
  say("gyro-noise", sqrtf(fmaxf(squares / 500 - mean * mean, 0)), "deg/s rms");
}

void setup() {
  while (!Serial) {
  }
  say("crystal-start", KEPT[0] / 20.97f, "us");
  say("pll-lock", KEPT[1] / 16.0f, "us");
  processor();
  Wire.begin();
  Wire.setClock(400000);
  bus();
  sensor();
  Serial.println("done");
}

void loop() {}
