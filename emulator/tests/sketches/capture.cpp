// Measures a pulse on pin 4 by waiting for it, and one on pin 3 with a timer's input capture.
#include <Arduino.h>

volatile uint16_t edges[8];
volatile int count;

static void captured() {
  if (FTM1_C0SC & 0x80) {
    FTM1_C0SC &= ~0x80;
    if (count < 8) edges[count++] = FTM1_C0V;
  }
}

void setup() {
  FTM1_SC = 0;
  FTM1_CNT = 0;
  FTM1_MOD = 0xFFFF;
  FTM1_C0SC = 0x4C;  // both edges, with interrupt
  FTM1_SC = FTM_SC_CLKS(1) | FTM_SC_PS(1);
  CORE_PIN3_CONFIG = PORT_PCR_MUX(3);
  attachInterruptVector(IRQ_FTM1, captured);
  NVIC_ENABLE_IRQ(IRQ_FTM1);
  pinMode(4, INPUT);
  while (!Serial) {
  }
  Serial.println("waiting");
  Serial.send_now();
  Serial.printf("pulse %lu\n", pulseIn(4, HIGH, 500000));
}

void loop() {
  if (count == 4) {
    noInterrupts();
    Serial.printf("widths %u %u\n", (uint16_t)(edges[1] - edges[0]), (uint16_t)(edges[3] - edges[2]));
    count = 8;
    interrupts();
  }
}
