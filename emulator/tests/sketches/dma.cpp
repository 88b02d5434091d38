// Memory to memory, to a serial port, and from the converter, by DMA.
#include <Arduino.h>
#include <DMAChannel.h>

DMAMEM static uint32_t source[64], target[64];
static uint8_t text[] = "sent by dma\n";
static volatile uint16_t samples[16];
static volatile bool finished;
DMAChannel copy, serial, sampler;

void done() {
  copy.clearInterrupt();
  finished = true;
}

void setup() {
  Serial1.begin(115200);
  while (!Serial) {
  }
  for (int i = 0; i < 64; i++) source[i] = i * 0x01010101;
  copy.sourceBuffer(source, sizeof(source));
  copy.destinationBuffer(target, sizeof(target));
  copy.disableOnCompletion();
  copy.interruptAtCompletion();
  copy.attachInterrupt(done);
  copy.triggerContinuously();
  copy.enable();
  uint32_t start = millis();
  while (!finished && millis() - start < 100) {
  }
  Serial.printf("copy %d %d\n", finished, memcmp(source, target, sizeof(source)));

  serial.sourceBuffer(text, sizeof(text) - 1);
  serial.destination(UART0_D);
  serial.disableOnCompletion();
  serial.triggerAtHardwareEvent(DMAMUX_SOURCE_UART0_TX);
  UART0_C5 |= UART_C5_TDMAS;
  UART0_C2 |= UART_C2_TIE;
  serial.enable();
  start = millis();
  while (!serial.complete() && millis() - start < 100) {
  }
  Serial.printf("serial %d\n", serial.complete());

  analogRead(A0);  // calibrates
  sampler.source(*(volatile uint16_t *)&ADC0_RA);
  sampler.destinationBuffer(samples, sizeof(samples));
  sampler.disableOnCompletion();
  sampler.triggerAtHardwareEvent(DMAMUX_SOURCE_ADC0);
  ADC0_SC2 |= ADC_SC2_DMAEN;
  ADC0_SC3 = ADC_SC3_ADCO;
  sampler.enable();
  ADC0_SC1A = 5;
  start = millis();
  while (!sampler.complete() && millis() - start < 100) {
  }
  Serial.printf("sampler %d %d %d\n", sampler.complete(), samples[0], samples[15]);
}

void loop() {}
